// sum-power-sing: (sum_j x_j)^-a, singular at the origin alone: of order a in d dimensions. Mean for
// a < d, variance for a < d/2. The origin gives infinity.
#ifdef KOKSMA_EXACT
#define KOKSMA_SUM_POWER_DIM 64  // the entry's largest dimension

static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// The density of S = sum x_j, M_n(s) = (s M_(n-1)(s) + (n - s) M_(n-1)(s - 1)) / (n - 1): de Boor's recurrence
// for B-splines with integer knots, positive weights.
static double density(double s, uint d) {
  double value[KOKSMA_SUM_POWER_DIM + 1];
  s = fmin(s, d - s);
  const uint cell = (uint)s;
  for (uint k = 0; k <= cell + 1; ++k) value[k] = k == cell ? 1 : 0;
  for (uint n = 2; n <= d; ++n)
    for (uint k = 0; k <= cell; ++k) {
      // Computed whether it is wanted or not: Intel's compiler (2026.2) goes wrong from 8 cells on
      // where the quotient is conditional.
      const double y = s - k, next = (y * value[k] + (n - y) * value[k + 1]) / (n - 1);
      value[k] = y >= n ? 0 : next;
    }
  return value[0];
}

// f = (d/2)^-a (1 + h), h = (2 S / d)^-a - 1. Mean of h, or its mean square about `centre`. On [0, 1] S has
// the density s^(d-1) / (d-1)!, and both are closed forms; from there on f is smooth, 16 points
// per half unit. The closed form of the whole (an alternating sum over k, d-th difference of
// k^(d-a)) cancels and has poles at integers a.
static double mean_rise(params q, uint d, double centre, bool squared) {
  const double a = q.a, log_middle = log(d / 2.0);
  const double rise = (expm1(a * log_middle) * d + a) / (d - a);  // mean of h for S <= 1
  const double spread = exp(2 * a * log_middle) * d * a * a / ((d - 2 * a) * (d - a) * (d - a));
  double sum = squared ? spread + (rise - centre) * (rise - centre) : rise;
  for (uint j = 2; j <= d; ++j) sum /= j;
  for (uint panel = 2; panel < 2 * d; ++panel)
    for (uint k = 0; k < 16; ++k) {
      double s, weight;
      legendre_16(k, 0.5, &s, &weight);
      s += panel / 2.0;
      const double h = expm1(-a * (log(s) - log_middle));
      sum += weight * density(s, d) * (squared ? (h - centre) * (h - centre) : h);
    }
  return sum;
}

static double exact_mean(params q, uint d) {
  return q.a < d ? pow(d / 2.0, -q.a) * (1 + mean_rise(q, d, 0, false)) : INFINITY;
}

static double exact_variance(params q, uint d) {
  if (2 * q.a >= d) return INFINITY;
  return pow(d / 2.0, -2 * q.a) * mean_rise(q, d, mean_rise(q, d, 0, false), true);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += points_next(p);
  return pow(sum, -(real)q.a);
}
#endif
