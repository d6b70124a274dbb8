// linear-2x2: y' = -Q diag(1 + x1, 10^(decades x2)) Q' y with Q the rotation by pi/6 and y(0) = (1, 0); f = y_1(1). A
// slow and a fast decay that no component shows alone.
#ifdef KOKSMA_EXACT
static double exponential_integral(double x);

// E exp(-k lambda) of the fast rate, uniform in its logarithm.
static double mean_fast(params q, double k) {
  return (exponential_integral(k) - exponential_integral(k * pow(10.0, q.decades))) / (q.decades * log(10.0));
}

// f = 3/4 exp(-(1 + x1)) + 1/4 exp(-lambda), two independent terms.
static double exact_mean(params q, uint d) { return 0.75 * (exp(-1.0) - exp(-2.0)) + 0.25 * mean_fast(q, 1); }
static double exact_variance(params q, uint d) {
  const double slow = exp(-1.0) - exp(-2.0), fast = mean_fast(q, 1);
  return 9.0 / 16 * ((exp(-2.0) - exp(-4.0)) / 2 - slow * slow) + 1.0 / 16 * (mean_fast(q, 2) - fast * fast);
}

static double exact_bound(params q, uint d) { return exp(-1.0); }
static double exact_stiffness(params q, uint d) { return fmax(2, pow(10.0, q.decades)) / q.steps; }
#else
struct ode {
  real slow, fast;
};

// By way of the eigenvectors: with the entries of the matrix the slow rate would be lost to the rounding of the fast
// one. Column by column of Q = (c -s; s c).
static inline void linear_map(const ode *m, real y0, real y1, real *f0, real *f1) {
  const real c = R(0.86602540378443864676), s = R(0.5);
  const real slow = m->slow * fma(c, y0, s * y1), fast = m->fast * fma(c, y1, -s * y0);
  *f0 = fma(-c, slow, s * fast);
  *f1 = -fma(s, slow, c * fast);
}

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) { linear_map(m, y[0], y[1], &f[0], &f[1]); }
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  linear_map(m, R(1.0), R(0.0), &j[0], &j[2]);
  linear_map(m, R(0.0), R(1.0), &j[1], &j[3]);
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = g[1] = R(0.0); }

static inline real integrand(points *p, params q, coefficients c) {
  ode m;
  m.slow = R(1.0) + points_next(p);
  m.fast = exp10((real)q.decades * points_next(p));
  real y[KOKSMA_ODE_SIZE] = {R(1.0), R(0.0)};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
