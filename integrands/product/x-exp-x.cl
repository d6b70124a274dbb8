// x-exp-x: prod_j x_j exp(x_j), mean 1; E f^2 = ((e^2 - 1) / 4)^d. Analytic.
// exp(d (1/2 - ln 2)) prod (2 x_j) exp(sum (x_j - 1/2)) is the same with one exponential a sample; all three
// factors stay near the size of f, where prod x_j and exp(sum x_j) apart would leave the range.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = exp(d * -0.19314718055994530942); }

static double exact_mean(params q, uint d) { return 1; }

// exp(d ln((e^2 - 1) / 4)) - 1; the logarithm as a pair of doubles, as d multiplies its error.
static double exact_variance(params q, uint d) {
  const double high = 0.4682921810112503, low = 1.6150339266602702e-17;
  const double t = d * high, error = fma((double)d, high, -t) + d * low;
  return expm1(t) + error * exp(t);
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(M_E, M_E, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0), exponent = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    product *= x + x;
    exponent += x - R(0.5);
  }
  return c[0] * (product * exp(exponent));
}
#endif
