// ladder-abs-pow: prod_j |x_j - 1/3|^p: the smoothness at planes that no base-2 net sees exactly is set by p, a
// ladder of rates. At an even p it is a polynomial.
#ifdef KOKSMA_EXACT
// 1/3 in two parts, so that x - 1/3 keeps its relative accuracy.
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = (float)(1.0 / 3);
  c[1] = fma(-3.0, c[0], 1.0) / 3;
}

// E |x - 1/3|^p = ((1/3)^(p+1) + (2/3)^(p+1)) / (p + 1)
static double moment(double p) { return (pow(1.0 / 3, p + 1) + pow(2.0 / 3, p + 1)) / (p + 1); }

static double exact_mean(params q, uint d) { return pow(moment(q.p), (double)d); }

static double exact_variance(params q, uint d) {
  const double m = moment(q.p), square = moment(2 * q.p);
  return pow(m, 2.0 * d) * expm1(d * log1p((square - m * m) / (m * m)));
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  const double below = pow(1.0 / 3, q.p), above = pow(2.0 / 3, q.p);
  for (uint j = 0; j < d; ++j) add_variation_factor(above, below + above, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= fabs((points_next(p) - c[2 * j]) - c[2 * j + 1]);
  return powr(product, (real)q.p);
}
#endif
