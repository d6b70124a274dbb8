// asian-geometric-call: e^(-rt) max(G - k, 0), G the geometric mean of d prices of a lognormal asset at times i t / d
// (Kemna & Vorst 1990), whatever the path is built from: ln G is linear in the normals, so weights alone stream. The
// integrand's file says what normal j weighs.
#ifdef KOKSMA_EXACT
static double weight_of(params q, uint d, uint j);

static double level_of(params q, uint d);

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = weight_of(q, d, j);
  c[1] = level_of(q, d);
  c[2] = q.k * exp(-q.r * q.t);
}

static double normal_density(double t) { return 0.398942280401432677940 * exp(-t * t / 2); }

static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// ln G is normal: level = E ln(G / k), spread^2 = Var ln G (Kemna & Vorst 1990).
static double level_of(params q, uint d) {
  return log(q.s0 / q.k) + (q.r - q.sigma * q.sigma / 2) * q.t * (d + 1.0) / (2.0 * d);
}

static double spread_of(params q, uint d) {
  return q.sigma * sqrt(q.t * (d + 1.0) * (2.0 * d + 1)) / (sqrt(6.0) * d);
}

// E f (power 1), or E (f - centre)^2 (power 2) over f > 0: f / (k e^(-rt)) = e^(spread y) - 1 at the height y of the
// standard normal above the kink. Black & Scholes' difference of two terms cancels where the spread is small or the
// option is far out of the money; this integrand is positive. Panels of length 1, beyond 10 deviations nothing.
static double payoff_moment(params q, uint d, uint power, double centre) {
  const double kink = -level_of(q, d) / spread_of(q, d), spread = spread_of(q, d);
  const double top = fmax(-kink, 0.0) + 2 * spread + 10;
  double sum = 0;
  for (uint panel = 0; panel < top; ++panel)
    for (uint i = 0; i < 16; ++i) {
      double y, weight;
      legendre_16(i, 1, &y, &weight);
      const double f = q.k * exp(-q.r * q.t) * expm1(spread * (panel + y)) - centre;
      sum += weight * normal_density(panel + y + kink) * (power == 2 ? f * f : f);
    }
  return sum;
}

static double exact_mean(params q, uint d) { return payoff_moment(q, d, 1, 0); }

// Below the kink f = 0 lies at the distance `mean` from the mean.
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d), kink = -level_of(q, d) / spread_of(q, d);
  return payoff_moment(q, d, 2, mean) + mean * mean * erfc(-kink * M_SQRT1_2) / 2;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = c[1];
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum = fma((real)c[3 * j], normal_quantile(points_next(p)), sum);
  const real payoff = c[2] * expm1(sum);
  return select_real(payoff < R(0.0), R(0.0), payoff);
}
#endif
