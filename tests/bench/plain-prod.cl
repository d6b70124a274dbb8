// plain-prod: linear-prod, drawn from points_next. The hand-written limits do these operations.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = q.scale / pow((double)(j + 1), q.power); }

static double exact_mean(params q, uint d) { return 1; }

static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = d; j-- > 0;) {
    const double g = q.scale / pow((double)(j + 1), q.power);
    variance += (1 + variance) * (g * g / 12);
  }
  return variance;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= R(1.0) + c[j] * (points_next(p) - R(0.5));
  return product;
}
#endif
