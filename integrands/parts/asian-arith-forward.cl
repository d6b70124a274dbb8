// asian-arith-forward: exact values of e^(-rt) times the arithmetic mean of d prices of a lognormal asset at times
// i t / d, whatever the path is built from.
#ifdef KOKSMA_EXACT
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
#endif
