// logistic: f = 1 / (1 + (1/x - 1) exp(-rate)), the solution at t = 1 of y' = rate y (1 - y), y(0) = x: a layer of
// width exp(-rate) at x = 0. form=naive writes it as x exp(rate) / (1 - x + x exp(rate)), which is Inf / Inf beyond
// the range.
#ifdef KOKSMA_EXACT
// With s = exp(-rate): 1/(1 - s) - rate s / (1 - s)^2.
static double exact_mean(params q, uint d) {
  const double s = exp(-q.rate), rest = -expm1(-q.rate);
  return 1 / rest - q.rate * s / (rest * rest);
}

// f = (1 - s/u) / (1 - s) with u uniform in (s, 1): E 1/u = rate / (1 - s), E 1/u^2 = 1/s. From rate 1 on the
// cancellation is below two digits.
static double exact_variance(params q, uint d) {
  const double s = exp(-q.rate), rest = -expm1(-q.rate), ratio = q.rate / rest;
  return s / (rest * rest) * (1 - s * ratio * ratio);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
#ifdef KOKSMA_FORM_NAIVE
  const real growth = x * exp((real)q.rate);
  return growth / (R(1.0) - x + growth);
#else
  return R(1.0) / fma(R(1.0) / x - R(1.0), exp(-(real)q.rate), R(1.0));
#endif
}
#endif
