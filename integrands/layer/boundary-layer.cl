// boundary-layer: prod_j exp(-x_j / eps) / (eps (1 - exp(-1 / eps))): all of the mean comes from a layer of width eps at
// the faces x_j = 0, which N points see once N eps^d is large.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = -1 / q.eps;
  c[1] = pown(-1 / (q.eps * expm1(-1 / q.eps)), (int)d);
}

// E g^2 = y coth y of one factor, y = 1 / (2 eps); prod - 1 term by term.
static double exact_variance(params q, uint d) {
  const double y = 0.5 / q.eps, excess = y / tanh(y) - 1;
  double variance = 0;
  for (uint j = 0; j < d; ++j) variance += (1 + variance) * excess;
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j)
    add_variation_factor(1 / (q.eps * expm1(1 / q.eps)), 1 / q.eps, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += points_next(p);
  return c[1] * exp(c[0] * sum);
}
#endif
