// prod-scaled-order: prod_j s_j (1 + (x_j - 1/2) / 10) with s_j = 2^shift in the first half of the dimensions, 2^-shift
// in the second (1 in the middle of odd d): f is near 1, but a product from left to right passes 2^(shift d / 2).
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) {
  const double scale = 2 * j + 1 < d ? exp2(q.shift) : (2 * j + 1 > d ? exp2(-q.shift) : 1);
  c[0] = 0.1 * scale;
  c[1] = scale;
}

// (1 + 1/1200)^d - 1
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = 0; j < d; ++j) variance += (1 + variance) / 1200;
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(1.05, 0.1, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
#if KOKSMA_FORM_NAIVE
    product *= fma((real)c[2 * j], points_next(p) - R(0.5), (real)c[2 * j + 1]);
#else
    // Without the s_j, whose product is 1.
    product *= fma(R(0.1), points_next(p) - R(0.5), R(1.0));
#endif
  }
  return product;
}
#endif
