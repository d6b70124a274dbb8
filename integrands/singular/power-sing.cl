// power-sing: prod_j (1 - a) x_j^-a, singular on the faces x_j = 0. Growth condition of Owen (2006). The
// variance is infinite from a = 1/2 on; x = 0 gives infinity.
#ifdef KOKSMA_EXACT
// The factor of the first k + 1 coordinates of a group of four.
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = pown(1 - q.a, (int)(j + 1)); }

// prod (1 + a^2 / (1 - 2a)) - 1, term by term; the largest double, not infinity, where it only leaves the range.
static double exact_variance(params q, uint d) {
  if (q.a >= 0.5) return INFINITY;
  double variance = 0;
  for (uint j = 0; j < d; ++j) variance += (1 + variance) * (q.a * q.a / (1 - 2 * q.a));
  return fmin(variance, DBL_MAX);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  // One pow for four coordinates, whose product stays above 2^-96 in fp32.
  real value = R(1.0), group = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    group *= points_next(p);
    if (j % 4 == 3 || j + 1 == KOKSMA_DIM) {
      value *= c[j % 4] * pow(group, -(real)q.a);
      group = R(1.0);
    }
  }
  return value;
}
#endif
