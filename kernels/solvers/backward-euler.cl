// backward-euler: y_(k+1) = y_k + h f(t_(k+1), y_(k+1)). Of order 1, but L-stable: fast transients are damped.
static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const real h = (t1 - t0) / (real)(scalar)steps;
  for (uint k = 0; k < steps; ++k) {
    real base[KOKSMA_ODE_SIZE];
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) base[i] = y[i];
    implicit_stage(m, fma((real)(scalar)(k + 1), h, t0), h, base, y);
  }
}
