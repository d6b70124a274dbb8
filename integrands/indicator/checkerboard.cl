// checkerboard: (-1)^(sum_j floor(k x_j)), k^d cells. For k = 2^m it is a finite Walsh function, which a
// base-2 net of 2^(t + m d) points or more integrates to exactly 0: a bitwise test of the net.
#ifdef KOKSMA_EXACT
// Other k than integers are not covered: the last cell would be cut.
static double exact_mean(params q, uint d) {
  if (q.k != floor(q.k)) return NAN;
  return fmod(q.k, 2.0) == 1 ? 1 / pown(q.k, (int)d) : 0;
}

static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return (1 - mean) * (1 + mean);
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// With the value on the faces x_j = 1, which no point set reaches, continued from inside.
static double exact_variation(params q, uint d) {
  if (q.k != floor(q.k)) return NAN;
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) add_variation_factor(1, 2 * (q.k - 1), &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  // The sum of the cells' numbers, at most 64 d, is exact; half of it tells odd from even.
  real cells = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) cells += floor((real)q.k * points_next(p));
  const real half_cells = R(0.5) * cells;
  return select_real(floor(half_cells) < half_cells, R(-1.0), R(1.0));
}
#endif
