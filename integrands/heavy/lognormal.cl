// lognormal: exp(sigma z), z the normal quantile of x: all moments are finite, but from sigma = 2 on few
// samples carry the mean.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return exp(q.sigma * q.sigma / 2); }

static double exact_variance(params q, uint d) {
  return exp(q.sigma * q.sigma) * expm1(q.sigma * q.sigma);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  return exp((real)q.sigma * normal_quantile(points_next(p)));
}
#endif
