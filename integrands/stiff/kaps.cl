// kaps: y1' = -(1/eps + 2) y1 + y2^2 / eps, y2' = y1 - y2 - y2^2, y(0) = (1, 1), eps = 10^(-decades x); the solution
// (exp(-2t), exp(-t)) does not depend on eps, so f = y1(1) is constant and every spread is the integrator's error.
#ifdef KOKSMA_EXACT
// The larger eigenvalue of the Jacobian at y2 = 1, where it is largest: trace -(s + 5), determinant s + 6, s = 1 / eps.
static double exact_stiffness(params q, uint d) {
  const double s = pow(10.0, q.decades), trace = s + 5;
  return (trace + sqrt(trace * trace - 4 * (s + 6))) / 2 / q.steps;
}
#else
struct ode {
  real rate;  // 1 / eps
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  f[0] = fma(m->rate, fma(y[1], y[1], -y[0]), R(-2.0) * y[0]);
  f[1] = y[0] - y[1] - y[1] * y[1];
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  j[0] = R(-2.0) - m->rate;
  j[1] = R(2.0) * m->rate * y[1];
  j[2] = R(1.0);
  j[3] = fma(R(-2.0), y[1], R(-1.0));
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = g[1] = R(0.0); }

static inline real integrand(points *p, params q, coefficients c) {
  const ode m = {exp10((real)q.decades * points_next(p))};
  real y[KOKSMA_ODE_SIZE] = {R(1.0), R(1.0)};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
