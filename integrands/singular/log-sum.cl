// log-sum: sum_j -ln x_j: additive, singular on the faces x_j = 0, where x = 0 gives infinity.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return d; }
static double exact_variance(params q, uint d) { return d; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  // A logarithm per coordinate: that of a product loses the digits of coordinates near 1.
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum -= log(points_next(p));
  return sum;
}
#endif
