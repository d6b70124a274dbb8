// cancel-cos: delta + prod_j sqrt(2) cos(2 pi x_j): mean delta beside a variance of 1, so relative accuracy is lost by
// E|f| / |I|.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return q.delta; }

// E |b + a cos| = 2/pi (sqrt(a^2 - b^2) + b asin(b/a)) at d = 1; beyond, that of delta = 0, which is off by less than
// delta^2 ln(1/delta)^d.
static double exact_mean_abs(params q, uint d) {
  if (d == 1) return 2 / M_PI * (sqrt(2 - q.delta * q.delta) + q.delta * asin(q.delta * M_SQRT1_2));
  return pown(2 * M_SQRT2 / M_PI, (int)d);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= R(1.4142135623730950488) * cospi(R(2.0) * points_next(p));
  return (real)q.delta + product;
}
#endif
