// decay-uniform: f = exp(-rate x), a decay with a rate that is uniform up to `rate`: all of the integral lies in a
// layer of width 1 / rate at x = 0, and the coefficient of variation is sqrt(rate / 2).
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return -expm1(-q.rate) / q.rate; }
// rate >= 1 keeps the cancellation below one digit.
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return -expm1(-2 * q.rate) / (2 * q.rate) - mean * mean;
}
#else
static inline real integrand(points *p, params q, coefficients c) { return exp(-(real)q.rate * points_next(p)); }
#endif
