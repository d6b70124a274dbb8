// asian-arith-call: e^(-rt) max((S_1 + S_2) / 2 - k, 0), prices of a lognormal asset at t / 2 and t, built from
// the increments of the path. Beyond d = 2 the arithmetic call has no exact value.
#ifdef KOKSMA_EXACT
static double step_drift(params q) { return (q.r - q.sigma * q.sigma / 2) * q.t / 2; }

static double step_deviation(params q) { return q.sigma * sqrt(q.t / 2); }

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = step_drift(q);
  c[1] = step_deviation(q);
  c[2] = q.s0 * exp(-q.r * q.t) / 2;
  c[3] = (q.s0 - q.k) * exp(-q.r * q.t);
}

static double normal_density(double t) { return 0.398942280401432677940 * exp(-t * t / 2); }

static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// E f (power 1) or E (f - centre)^2 (power 2). Given the second normal z the payoff is a call on S_1 with the factor
// (1 + e^(drift + b z)) / 2 and the strike k, so f / (k e^(-rt)) = e^(b y) - 1 at the height y of the first normal
// above its kink, which is analytic in z. Positive integrands in panels of length 1: nothing cancels.
static double payoff_moment(params q, uint power, double centre) {
  const double b = step_deviation(q), price = q.k * exp(-q.r * q.t);
  double total = 0;
  for (uint at = 0; at < 16 * 34; ++at) {  // z from -12 to 22: beyond a density of 1e-16 of the payoff's own
    double z, outer;
    legendre_16(at % 16, 1, &z, &outer);
    z += at / 16 - 12.0;
    const double growth = step_drift(q) + b * z;
    const double kink = (log(q.k / q.s0) - step_drift(q) - log1p(expm1(growth) / 2)) / b;
    double sum = power == 2 ? centre * centre * erfc(-kink * M_SQRT1_2) / 2 : 0;
    const double top = fmax(-kink, 0.0) + 2 * b + 10;
    for (uint panel = 0; panel < top; ++panel)
      for (uint i = 0; i < 16; ++i) {
        double y, weight;
        legendre_16(i, 1, &y, &weight);
        const double f = price * expm1(b * (panel + y)) - centre;
        sum += weight * normal_density(panel + y + kink) * (power == 2 ? f * f : f);
      }
    total += outer * normal_density(z) * sum;
  }
  return total;
}

static double exact_mean(params q, uint d) { return payoff_moment(q, 1, 0); }

static double exact_variance(params q, uint d) { return payoff_moment(q, 2, exact_mean(q, d)); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real path = R(0.0), sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    path = fma((real)c[1], normal_quantile(points_next(p)), path + c[0]);
    sum += expm1(path);  // prices less s0: little cancels at a strike near s0
  }
  const real payoff = fma((real)c[2], sum, (real)c[3]);
  return select_real(payoff < R(0.0), R(0.0), payoff);
}
#endif
