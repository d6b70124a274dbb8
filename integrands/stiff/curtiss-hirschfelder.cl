// curtiss-hirschfelder: y' = -lambda (y - cos t), y(0) = 0, lambda = 10^(decades x); f = y(1) = (lambda^2 cos 1 +
// lambda sin 1 - lambda^2 exp(-lambda)) / (1 + lambda^2). The problem for which stiffness was named.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

static double solution(double rate) {
  const double slow = 1 / rate;
  return (cos(1.0) + slow * sin(1.0) - exp(-rate)) / (1 + slow * slow);
}

// E (f - centre)^power in panels of about a quarter of a decade of lambda; f has its poles at lambda = +-i.
static double moment(params q, double centre, int power) {
  const uint parts = (uint)ceil(4 * q.decades);
  double sum = 0;
  for (uint part = 0; part < parts; ++part)
    for (uint k = 0; k < 16; ++k) {
      double x, weight;
      legendre_16(k, 1.0 / parts, &x, &weight);
      sum += weight * pown(solution(pow(10.0, q.decades * (part / (double)parts + x))) - centre, power);
    }
  return sum;
}

static double exact_mean(params q, uint d) { return moment(q, 0, 1); }
static double exact_variance(params q, uint d) { return moment(q, moment(q, 0, 1), 2); }

static double exact_stiffness(params q, uint d) { return pow(10.0, q.decades) / q.steps; }
#else
struct ode {
  real rate;
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) { f[0] = -m->rate * (y[0] - cos(t)); }
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) { j[0] = -m->rate; }
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = -m->rate * sin(t); }

static inline real integrand(points *p, params q, coefficients c) {
  const ode m = {exp10((real)q.decades * points_next(p))};
  real y[KOKSMA_ODE_SIZE] = {R(0.0)};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
