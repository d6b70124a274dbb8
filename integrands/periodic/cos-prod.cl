// cos-prod: prod_j (1 + g_j cos 2 pi x_j), g_j = scale j^-power: a trigonometric polynomial with the frequencies
// {-1, 0, 1}^d. A lattice integrates it exactly once its dual lattice holds none of them but 0.
#ifdef KOKSMA_EXACT
static double gamma_of(params q, uint j) { return q.scale / pow((double)(j + 1), q.power); }

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = 2 * gamma_of(q, j);
  c[1] = 1 - gamma_of(q, j);
}

static double exact_mean(params q, uint d) { return 1; }

// prod (1 + g^2 / 2) - 1 without a subtraction, from the small terms up.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = d; j-- > 0;) {
    const double g = gamma_of(q, j);
    variance += (1 + variance) * (g * g / 2);
  }
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from 1 + g to 1 - g and rises again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double g = gamma_of(q, j);
    add_variation_factor(1 + g, 4 * g, &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    // 1 + g cos 2t = (1 - g) + 2 g cos^2 t has no cancellation where g is near 1 and x near 1/2.
    const real y = cospi(points_next(p));
    product *= fma(c[2 * j] * y, y, (real)c[2 * j + 1]);
  }
  return product;
}
#endif
