// log1m-sum: sum_j -ln(1 - x_j): additive, singular at the far faces. 1 - x is exact for all coordinates,
// and log(1 - x) rather than log1p(-x) makes a coordinate that was rounded to 1 show as infinity.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return d; }
static double exact_variance(params q, uint d) { return d; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum -= log(R(1.0) - points_next(p));
  return sum;
}
#endif
