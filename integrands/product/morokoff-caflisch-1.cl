// morokoff-caflisch-1: (1 + 1/d)^d prod_j x_j^(1/d), mean 1. Morokoff & Caflisch (1995). The first derivatives
// grow without bound at the faces x_j = 0 and are not square integrable.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = exp(d * log1p(1.0 / d)); }

static double exact_mean(params q, uint d) { return 1; }

// ((1 + 1/d)^2 / (1 + 2/d))^d - 1, and (1 + 1/d)^2 / (1 + 2/d) = 1 + 1 / (d (d + 2)).
static double exact_variance(params q, uint d) { return expm1(d * log1p(1 / (d * (d + 2.0)))); }

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(1 + 1.0 / d, 1 + 1.0 / d, &variation, &at_one);
  return variation;
}
#else
// One logarithm for as many coordinates as cannot underflow: a positive one is 2^-24 (fp64: 2^-53) at least.
#if KOKSMA_FP64
#define KOKSMA_ROOT_GROUP 16
#else
#define KOKSMA_ROOT_GROUP 4
#endif
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0), sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    product *= points_next(p);
    if ((j + 1) % KOKSMA_ROOT_GROUP == 0 || j + 1 == KOKSMA_DIM) {
      sum += log2(product);
      product = R(1.0);
    }
  }
  return c[0] * exp2(sum / (real)KOKSMA_DIM);
}
#endif
