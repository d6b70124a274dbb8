// recip-1px: prod_j 1 / ((1 + x_j) ln 2), mean 1; E f^2 = (1 / (2 ln^2 2))^d. Analytic, poles at x_j = -1.
// One division a sample: 11/16 (1 + x) is close to 1 on average, and (11 / (16 ln 2))^d comes from the host.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = exp(d * -0.008180528859746367); }

static double exact_mean(params q, uint d) { return 1; }

// exp(-d ln(2 ln^2 2)) - 1; the logarithm as a pair of doubles, as d multiplies its error.
static double exact_variance(params q, uint d) {
  const double high = 0.03987866060338335, low = -1.953566424000912e-18;
  const double t = d * high, error = fma((double)d, high, -t) + d * low;
  return expm1(t) + error * exp(t);
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from 1 / ln 2 to half of it.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(M_LOG2E / 2, M_LOG2E / 2, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= fma(points_next(p), R(0.6875), R(0.6875));
  return c[0] / product;
}
#endif
