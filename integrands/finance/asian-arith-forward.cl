// asian-arith-forward: e^(-rt) times the arithmetic mean of d prices of a lognormal asset at times i t / d, an Asian
// call of strike 0; the path is built from its increments.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = (q.r - q.sigma * q.sigma / 2) * q.t / d;
  c[1] = q.sigma * sqrt(q.t / d);
  c[2] = q.s0 * exp(-q.r * q.t) / d;
}

// s0 / d times the sum of e^(-r (t - t_i)), a geometric series.
static double exact_mean(params q, uint d) {
  const double step = -q.r * q.t / d;
  return q.s0 / d * (q.r == 0 ? d : expm1(-q.r * q.t) / expm1(step));
}

// (s0 / d)^2 times the sum over i, l of e^(-r (2 t - t_i - t_l)) (e^(sigma^2 min(t_i, t_l)) - 1), the later time
// summed first.
static double exact_variance(params q, uint d) {
  double variance = 0, later = 0;
  for (uint i = d; i > 0; --i) {
    const double growth = exp(-q.r * q.t * (d - i) / d);
    variance += expm1(q.sigma * q.sigma * q.t * i / d) * growth * (growth + 2 * later);
    later += growth;
  }
  return q.s0 / d * (q.s0 / d) * variance;
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
