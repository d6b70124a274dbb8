// explicit-euler: y += h f(t, y). Stable for |1 + h lambda| <= 1 only: the specimen of what stiffness does.
static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const real h = (t1 - t0) / (real)(scalar)steps;
  for (uint k = 0; k < steps; ++k) {
    real f[KOKSMA_ODE_SIZE];
    ode_rhs(m, fma((real)(scalar)k, h, t0), y, f);
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) y[i] = fma(h, f[i], y[i]);
  }
}
