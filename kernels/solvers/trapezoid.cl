// trapezoid: y_(k+1) = y_k + h/2 (f_k + f_(k+1)). A-stable but not L-stable: R(-z) -> -1, so that fast
// transients are not damped but change their sign in every step.
static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const real h = (t1 - t0) / (real)(scalar)steps, half_step = R(0.5) * h;
  for (uint k = 0; k < steps; ++k) {
    real base[KOKSMA_ODE_SIZE];
    ode_rhs(m, fma((real)(scalar)k, h, t0), y, base);
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) base[i] = fma(half_step, base[i], y[i]);
    implicit_stage(m, fma((real)(scalar)(k + 1), h, t0), half_step, base, y);
  }
}
