// halfpi-sin: prod_j (pi / 2) sin(pi x_j), mean 1; E f^2 = (pi^2 / 8)^d. Its 1-periodic extension has a kink at the
// integers: Korobov class alpha = 2. Roos & Arnold (1963), their third function.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return 1; }

// (pi^2 / 8)^d - 1, built up without a subtraction.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = 0; j < d; ++j) variance += (1 + variance) * 0.233700550136169827354311374984518892;
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor rises from 0 to pi / 2 and falls to 0 again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(0, M_PI, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= R(1.5707963267948966) * sinpi(points_next(p));
  return product;
}
#endif
