// rk4: the classical Runge-Kutta method of order 4. Explicit: stable for -2.785 < h lambda < 0 on the real axis.
static inline void rk4_stage(const ode *m, real t, real c, const real *y, const real *slope, real *next) {
  real state[KOKSMA_ODE_SIZE];
  KOKSMA_UNROLL
  for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) state[i] = fma(c, slope[i], y[i]);
  ode_rhs(m, t, state, next);
}

static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const real h = (t1 - t0) / (real)(scalar)steps;
  for (uint k = 0; k < steps; ++k) {
    const real t = fma((real)(scalar)k, h, t0), middle = fma(R(0.5), h, t), end = fma((real)(scalar)(k + 1), h, t0);
    real k1[KOKSMA_ODE_SIZE], k2[KOKSMA_ODE_SIZE], k3[KOKSMA_ODE_SIZE], k4[KOKSMA_ODE_SIZE];
    ode_rhs(m, t, y, k1);
    rk4_stage(m, middle, R(0.5) * h, y, k1, k2);
    rk4_stage(m, middle, R(0.5) * h, y, k2, k3);
    rk4_stage(m, end, h, y, k3, k4);
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i)
      y[i] = fma(h / R(6.0), (k1[i] + k4[i]) + R(2.0) * (k2[i] + k3[i]), y[i]);
  }
}
