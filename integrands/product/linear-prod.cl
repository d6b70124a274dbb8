// linear-prod: prod_j (1 + gamma_j (x_j - 1/2)), gamma_j = scale / j^power.
// The low or high effective dimension is set by the decay of gamma (Sloan & Wozniakowski 1998).
#ifdef KOKSMA_EXACT
static double gamma_of(params q, uint j) { return q.scale / pow((double)(j + 1), q.power); }

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = gamma_of(q, j); }

static double exact_mean(params q, uint d) { return 1; }

// prod (1 + gamma^2/12) - 1, built up term by term without a subtraction, from the small terms (power >=
// 0: the last) up.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = d; j-- > 0;) {
    const double g = gamma_of(q, j);
    variance += (1 + variance) * (g * g / 12);
  }
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double g = gamma_of(q, j);
    add_variation_factor(1 + g / 2, fabs(g), &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= R(1.0) + (c[j] * KOKSMA_CENTRED_UNIT) * points_next_centred(p);
  return product;
}
#endif
