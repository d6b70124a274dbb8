// bateman-chain: A' = -k1 A, B' = k1 A - k2 B, C' = k2 B with rates that cross, by a solver; f = C(1). Exact values:
// parts/bateman-chain.cl.
#ifdef KOKSMA_EXACT
static double exact_bound(params q, uint d) { return -expm1(-1.5); }
static double exact_stiffness(params q, uint d) { return 1e6 / q.steps; }
#else
struct ode {
  real first, second;
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  const real made = m->first * y[0], lost = m->second * y[1];
  f[0] = -made;
  f[1] = made - lost;
  f[2] = lost;
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  j[0] = -m->first;
  j[3] = m->first;
  j[4] = -m->second;
  j[7] = m->second;
  j[1] = j[2] = j[5] = j[6] = j[8] = R(0.0);
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) {
  g[0] = g[1] = g[2] = R(0.0);
}

static inline real integrand(points *p, params q, coefficients c) {
  ode m;
  m.first = R(0.5) + points_next(p);
  m.second = exp10(fma(R(7.0), points_next(p), R(-1.0)));
  real y[KOKSMA_ODE_SIZE] = {R(1.0), R(0.0), R(0.0)};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[2];
}
#endif
