// prothero-robinson: y' = -lambda (y - phi(t)) + phi'(t), phi(t) = sin(t + x2), lambda = 10^(decades x1),
// y(0) = phi(0) + delta; f = y(1) = phi(1) + delta exp(-lambda). delta = 0: the solution is smooth for every lambda and
// shows the order that is left (order reduction); delta = 1: the transient must be damped.
#ifdef KOKSMA_EXACT
static double exponential_integral(double x);

static double log_rates(params q) { return q.decades * log(10.0); }

// E exp(-k lambda) for lambda uniform in its logarithm.
static double mean_transient(params q, double k) {
  const double largest = pow(10.0, q.decades);
  return (exponential_integral(k) - exponential_integral(k * largest)) / log_rates(q);
}

static double exact_mean(params q, uint d) { return cos(1.0) - cos(2.0) + q.delta * mean_transient(q, 1); }

// The two terms are independent.
static double exact_variance(params q, uint d) {
  const double mean = cos(1.0) - cos(2.0), transient = mean_transient(q, 1);
  const double phase = 0.5 - (sin(4.0) - sin(2.0)) / 4 - mean * mean;
  return phase + q.delta * q.delta * (mean_transient(q, 2) - transient * transient);
}

static double exact_bound(params q, uint d) { return 1 + q.delta * exp(-1.0); }
static double exact_stiffness(params q, uint d) { return pow(10.0, q.decades) / q.steps; }
#else
struct ode {
  real rate, phase;
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  const real s = t + m->phase;
  f[0] = fma(-m->rate, y[0] - sin(s), cos(s));
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) { j[0] = -m->rate; }
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) {
  const real s = t + m->phase;
  g[0] = fma(m->rate, cos(s), -sin(s));
}

static inline real integrand(points *p, params q, coefficients c) {
  ode m;
  m.rate = exp10((real)q.decades * points_next(p));
  m.phase = points_next(p);
  real y[KOKSMA_ODE_SIZE] = {sin(m.phase) + (real)q.delta};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
