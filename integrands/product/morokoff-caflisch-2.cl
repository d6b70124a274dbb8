// morokoff-caflisch-2: prod_j (d - x_j) / (d - 1/2), mean 1. Morokoff & Caflisch (1995); "type B" of Kucherenko et al.
// (2011): the variance falls like 1 / (12 d), and nearly all of it lies in the single coordinates.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = 1 / (d - 0.5); }

static double exact_mean(params q, uint d) { return 1; }

// (1 + 1 / (12 (d - 1/2)^2))^d - 1
static double exact_variance(params q, uint d) {
  return expm1(d * log1p(1 / (12 * ((d - 0.5) * (d - 0.5)))));
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor((d - 1) / (d - 0.5), 1 / (d - 0.5), &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= fma((real)c[j], R(0.5) - points_next(p), R(1.0));
  return product;
}
#endif
