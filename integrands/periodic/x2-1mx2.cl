// x2-1mx2: prod_j 30 x_j^2 (1 - x_j)^2, mean 1; E f^2 = (10/7)^d, as 900 B(5, 5) = 10/7.
// Its 1-periodic extension has two continuous derivatives: Korobov class alpha = 4.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return 1; }
static double exact_variance(params q, uint d) { return expm1(d * log1p(3.0 / 7.0)); }
static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor rises from 0 to 15/8 and falls to 0 again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(0, 3.75, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    const real y = x * (R(1.0) - x);  // x - x^2 cancels near 1
    product *= R(30.0) * y * y;
  }
  return product;
}
#endif
