// endpoint-probit-sq: the square of the normal quantile of x: infinite at x = 0 and at 1, where conversions of integers
// that round up arrive. On centred coordinates of b bits the mean is short by about 1.34 2^-b.
#ifndef KOKSMA_EXACT
static inline real integrand(points *p, params q, coefficients c) {
  const real z = normal_quantile(points_next(p));
  return z * z;
}
#endif
