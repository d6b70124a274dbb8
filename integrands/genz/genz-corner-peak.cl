// genz-corner-peak: (1 + sum_j a_j x_j)^-(d+1), a_j = h (2j - 1) / d^2. Genz (1984), family 3.
// Typical values are near (1 + h/2)^-(d+1), which leaves the normal fp32 range at d = 133 for h = 1.85.
#ifdef KOKSMA_EXACT
static double a_of(params q, uint d, uint j) { return q.h * (2.0 * j + 1) / ((double)d * d); }

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = a_of(q, d, j); }

// Integrand of 1/(p-1)! int t^p e^-t prod (1 - e^(-a_j t)) / (a_j t) d(log t) at t; p = d + 1 or 2d + 2.
// The factors t/k of t^p / (p-1)! are spread over the product, so that nothing overflows.
static double laplace_term(params q, uint d, uint p, double t) {
  double term = t * exp(-t);
  for (uint j = 0; j < d; ++j) {
    const double a = a_of(q, d, j);
    term *= -expm1(-a * t) / (a * (j + 1));
  }
  for (uint k = d + 1; k < p; ++k) term *= t / k;
  return term;
}

// E (1 + S)^-p = 1/Gamma(p) int t^(p-1) e^-t prod (1 - e^(-a_j t)) / (a_j t) dt: positive, where
// inclusion-exclusion cancels (3.9e-10 at d = 10). The trapezoidal rule in log t converges exponentially
// (Trefethen & Weideman 2014).
static double negative_moment(params q, uint d, uint p) {
  const double step = 0.25 / sqrt((double)p), start = log((double)p / 2);
  double sum = laplace_term(q, d, p, exp(start));
  for (int direction = -1; direction <= 1; direction += 2) {
    double previous = 0;
    for (uint k = 1; k < 4000; ++k) {
      const double term = laplace_term(q, d, p, exp(start + direction * (k * step)));
      sum += term;
      if (term <= previous && term < 1e-20 * sum) break;
      previous = term;
    }
  }
  return sum * step;
}

static double exact_mean(params q, uint d) { return negative_moment(q, d, d + 1); }

static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return negative_moment(q, d, 2 * d + 2) - mean * mean;
}

// The mixed differences of (1 + sum a_j x_j)^-p over any face have the sign (-1)^(dimension), as f is a mixture of
// products of decreasing exponentials. So no difference cancels another, and the sum over all faces at 1
// telescopes to f(0) - f(1), with sum a_j = h.
static double exact_variation(params q, uint d) { return -expm1(-(d + 1.0) * log1p(q.h)); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum = fma((real)c[j], points_next(p), sum);
  // Powers of the reciprocal: small results underflow gradually instead of passing through infinity.
  real square = R(1.0) / sum, power = R(1.0);
  for (uint e = KOKSMA_DIM + 1; e != 0; e >>= 1) {
    if (e & 1) power *= square;
    square *= square;
  }
  return power;
}
#endif
