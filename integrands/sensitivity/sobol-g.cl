// sobol-g: prod_j (|4 x_j - 2| + a_j) / (1 + a_j), a_j = scale j^power + offset. Saltelli & Sobol' (1995).
// The kinks at x_j = 1/2 are dyadic: base-2 nets see them exactly and look better than they are elsewhere.
#ifdef KOKSMA_EXACT
static double a_of(params q, uint j) { return q.scale * pow((double)(j + 1), q.power) + q.offset; }

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = 4 / (1 + a_of(q, j));
  c[1] = a_of(q, j) / (1 + a_of(q, j));
}

// Each factor has mean 1; it is undefined where 1 + a_j vanishes, and every a_j lies above a_1.
static double exact_mean(params q, uint d) { return a_of(q, 0) > -1 ? 1 : NAN; }

// prod (1 + 1 / (3 (1 + a_j)^2)) - 1, built up term by term without a subtraction, from the small terms up.
static double exact_variance(params q, uint d) {
  if (!(a_of(q, 0) > -1)) return NAN;
  double variance = 0;
  for (uint j = d; j-- > 0;) {
    const double b = 1 + a_of(q, j);
    variance += (1 + variance) / (3 * b * b);
  }
  return variance;
}

// |4x - 2| = y is uniform on (0,2): E|y + a| = 1 + a for a >= 0, and (a^2 + (2 + a)^2) / 4 for -1 < a < 0.
static double exact_mean_abs(params q, uint d) {
  if (!(a_of(q, 0) > -1)) return NAN;
  double product = 1;
  for (uint j = 0; j < d; ++j) {
    const double a = a_of(q, j);
    if (a < 0) product *= (a * a + (2 + a) * (2 + a)) / (4 * (1 + a));
  }
  return product;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from (2 + a) / (1 + a) by 2 / (1 + a) and rises again.
static double exact_variation(params q, uint d) {
  if (!(a_of(q, 0) > -1)) return NAN;
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double a = a_of(q, j);
    add_variation_factor((2 + a) / (1 + a), 4 / (1 + a), &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j)
    product *= fma((real)c[2 * j], fabs(points_next(p) - R(0.5)), (real)c[2 * j + 1]);
  return product;
}
#endif
