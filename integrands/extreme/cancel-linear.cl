// cancel-linear: a (x_1 - 1/2) + x_2: the mean is that of x_2, which fp32 loses beside a = 1e8, where its unit in the last
// place is 8. The first 2^m points of an unscrambled net are off by a 2^-(m+1).
#ifdef KOKSMA_EXACT
static double exact_variance(params q, uint d) { return (q.a * q.a + 1) / 12; }

// Given x_2 = y: (a^2 / 4 + y^2) / a, for a >= 2.
static double exact_mean_abs(params q, uint d) { return q.a / 4 + 1 / (3 * q.a); }

static double exact_variation(params q, uint d) { return q.a + 1; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p) - R(0.5);
  return fma((real)q.a, x, points_next(p));
}
#endif
