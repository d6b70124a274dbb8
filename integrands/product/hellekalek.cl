// hellekalek: prod_j (x_j^alpha - 1 / (1 + alpha)), mean 0, all variance in the interaction of all coordinates.
// Hellekalek (1998). It is not normalised: sigma = 0.29^d at alpha = 1.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = 1 / (1 + q.alpha); }

static double exact_mean(params q, uint d) { return 0; }

static double exact_variance(params q, uint d) {
  const double m = 1 + q.alpha;
  return pow(q.alpha * q.alpha / ((1 + 2 * q.alpha) * (m * m)), (double)d);
}

// With m = 1 / (1 + alpha) and x^alpha < m below x0 = m^(1/alpha): E|g| = 2 int_0^x0 (m - x^alpha) = 2 x0 m (1 - m).
static double exact_mean_abs(params q, uint d) {
  const double m = 1 / (1 + q.alpha);
  return pow(2 * pow(m, 1 / q.alpha) * m * (1 - m), (double)d);
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(q.alpha / (1 + q.alpha), 1, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    real x = points_next(p);
    if (q.alpha != 1) x = powr(x, (real)q.alpha);
    product *= x - c[j];
  }
  return product;
}
#endif
