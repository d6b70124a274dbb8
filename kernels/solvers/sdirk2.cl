// sdirk2: Alexander's L-stable method of two stages, y1 = y + g h f1, y2 = y + (1 - g) h f1 + g h f2 with
// g = 1 - 1/sqrt(2) (SIAM J. Numer. Anal. 14 (1977)); stiffly accurate, the second stage is the result.
static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const real h = (t1 - t0) / (real)(scalar)steps, c = R(0.29289321881345247560) * h;
  for (uint k = 0; k < steps; ++k) {
    real first[KOKSMA_ODE_SIZE], base[KOKSMA_ODE_SIZE];
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) first[i] = y[i];
    implicit_stage(m, fma((real)(scalar)k, h, t0) + c, c, y, first);
    // h f1 is (first - y) / g: evaluating f would multiply the rounding of the stage by h lambda. (1 - g) / g = 1 +
    // sqrt(2).
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) {
      base[i] = fma(R(2.41421356237309504880), first[i] - y[i], y[i]);
      y[i] = first[i];
    }
    implicit_stage(m, fma((real)(scalar)(k + 1), h, t0), c, base, y);
  }
}
