// ladder-x-pow: prod_j x_j^p: the smoothness at the face x_j = 0 is set by p, a ladder of rates.
// At an integer p it is a polynomial.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return pow(1 + q.p, -(double)d); }

// mean^2 ((E g^2 / (E g)^2)^d - 1), where (1 + p)^2 / (1 + 2p) = 1 + p^2 / (1 + 2p)
static double exact_variance(params q, uint d) {
  return pow(1 + q.p, -2.0 * d) * expm1(d * log1p(q.p * q.p / (1 + 2 * q.p)));
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(1, 1, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= points_next(p);
  return powr(product, (real)q.p);
}
#endif
