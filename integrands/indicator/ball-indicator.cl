// ball-indicator: 1{|x|^2 <= 1}, the orthant of the unit ball, at most 1 part in 10^10 of the cube from
// d = 19 on.
#ifdef KOKSMA_EXACT
// V_d = V_(d-2) pi / (2 d) from V_0 = V_1 = 1 (DLMF 5.19.4): lgamma would lose digits in exp.
static double exact_mean(params q, uint d) {
  double volume = 1;
  for (uint n = 2 + d % 2; n <= d; n += 2) volume *= M_PI / (2 * n);
  return volume;
}

static double exact_variance(params q, uint d) { return exact_mean(q, d) * (1 - exact_mean(q, d)); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    sum = fma(x, x, sum);
  }
  return select_real(sum <= R(1.0), R(1.0), R(0.0));
}
#endif
