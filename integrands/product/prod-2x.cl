// prod-2x: prod_j 2 x_j, mean 1; E f^2 = (4/3)^d. "Type C" of Kucherenko et al. (2011): interactions of all orders
// matter. At d >= 100 no sample count resolves it: a typical sample, about exp(-0.307 d), is far below the mean.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static double exact_mean(params q, uint d) { return 1; }

// exp(d ln(4/3)) - 1; the logarithm as a pair of doubles, as d multiplies its error.
static double exact_variance(params q, uint d) {
  const double high = 0.2876820724517809, low = 2.607160616442564e-17;
  const double t = d * high, error = fma((double)d, high, -t) + d * low;
  return expm1(t) + error * exp(t);
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(2, 2, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    product *= x + x;
  }
  return product;
}
#endif
