// asian-arith-forward: e^(-rt) times the arithmetic mean of d prices of a lognormal asset at times i t / d, an Asian
// call of strike 0; the path is built from its increments.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = (q.r - q.sigma * q.sigma / 2) * q.t / d;
  c[1] = q.sigma * sqrt(q.t / d);
  c[2] = q.s0 * exp(-q.r * q.t) / d;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real path = R(0.0), sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    // The log price is small, so its sum rounds less than a running product of prices.
    path = fma((real)c[1], normal_quantile(points_next(p)), path + c[0]);
    sum += exp(path);
  }
  return c[2] * sum;
}
#endif
