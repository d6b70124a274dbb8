// decay-loguniform: f = exp(-k), k = 10^(lowest + (highest - lowest) x): what is left of an exponential decay whose
// rate is known by its order of magnitude only. In closed form: the layer without an integrator's error.
#ifdef KOKSMA_EXACT
static double exponential_integral(double x);

// E exp(-power k) for k uniform in its logarithm.
static double mean_power(params q, double power) {
  return (exponential_integral(power * pow(10.0, q.lowest)) - exponential_integral(power * pow(10.0, q.highest))) /
         ((q.highest - q.lowest) * log(10.0));
}

static double exact_mean(params q, uint d) { return mean_power(q, 1); }
static double exact_variance(params q, uint d) {
  const double mean = mean_power(q, 1);
  return mean_power(q, 2) - mean * mean;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  return exp(-exp10(fma((real)(q.highest - q.lowest), points_next(p), (real)q.lowest)));
}
#endif
