// reversible-ab: the reaction A <-> B, forward rate kappa (1 + x1), backward rate kappa = 10^(decades x2), from pure A;
// f = A(1) = 1 / (2 + x1) + (1 + x1) / (2 + x1) exp(-kappa (2 + x1)). The matrix is singular: A + B is conserved.
#ifdef KOKSMA_EXACT
static double exponential_integral(double x);
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// E exp(-s kappa) for kappa uniform in its logarithm.
static double mean_transient(params q, double s) {
  return (exponential_integral(s) - exponential_integral(s * pow(10.0, q.decades))) / (q.decades * log(10.0));
}

static double exact_mean(params q, uint d) {
  double mean = log(1.5);
  for (uint k = 0; k < 16; ++k) {
    double x, weight;
    legendre_16(k, 1, &x, &weight);
    mean += weight * (1 + x) / (2 + x) * mean_transient(q, 2 + x);
  }
  return mean;
}

// About the mean: the variance is a hundredth of the mean square.
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  double sum = 0;
  for (uint k = 0; k < 16; ++k) {
    double x, weight;
    legendre_16(k, 1, &x, &weight);
    const double left = 1 / (2 + x) - mean, moved = (1 + x) / (2 + x);
    sum += weight * (left * left + 2 * left * moved * mean_transient(q, 2 + x) +
                     moved * moved * mean_transient(q, 2 * (2 + x)));
  }
  return sum;
}

static double exact_bound(params q, uint d) { return 0.5 + 0.5 * exp(-2.0); }
static double exact_stiffness(params q, uint d) { return 3 * pow(10.0, q.decades) / q.steps; }
#else
struct ode {
  real forward, backward;
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  f[1] = fma(m->forward, y[0], -m->backward * y[1]);
  f[0] = -f[1];
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  j[0] = -m->forward;
  j[1] = m->backward;
  j[2] = m->forward;
  j[3] = -m->backward;
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = g[1] = R(0.0); }

static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
  ode m;
  m.backward = exp10((real)q.decades * points_next(p));
  m.forward = fma(m.backward, x, m.backward);
  real y[KOKSMA_ODE_SIZE] = {R(1.0), R(0.0)};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
