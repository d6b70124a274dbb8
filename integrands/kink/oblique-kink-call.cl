// oblique-kink-call: max(sum_j x_j - t, 0), the payoff of a call: one kink along an oblique plane.
// The moments are those of the Irwin-Hall distribution beyond t.
#ifdef KOKSMA_EXACT
// The shorter of both tails never has more than d/2 + 1 integer shifts; 512 is the entry's largest dimension.
#define KOKSMA_KINK_SHIFTS (512 / 2 + 2)

// G_d(t) = E (t - S_d)_+^r / r! for r = 1, 2 and 0 <= t <= d/2, by
// (n + r) G_n(t) = t G_(n-1)(t) + (n - t) G_(n-1)(t - 1), de Boor's recurrence for B-splines with integer knots,
// integrated r + 1 times: positive weights for t < n, where the alternating sum over k cancels; beyond t = n the
// moment of a polynomial.
static double lower_moment(double t, uint d, uint r) {
  double moment[KOKSMA_KINK_SHIFTS];
  if (!(t > 0)) return 0;
  const uint shifts = (uint)t + 1;  // G(t - k) vanishes from k = shifts on
  moment[shifts] = 0;
  for (uint n = 0; n <= d; ++n)
    for (uint k = 0; k < shifts; ++k) {
      const double s = t - k, a = s - n / 2.0;
      if (s >= n) moment[k] = r == 1 ? a : (a * a + n / 12.0) / 2;
      else moment[k] = (s * moment[k] + (n - s) * moment[k + 1]) / (n + r);
    }
  return moment[0];
}

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = (float)(q.t - d / 2.0);
  c[1] = (q.t - d / 2.0) - c[0];
}

// E (S - t)_+ = E (S - t) + E (t - S)_+, and S and d - S have the same law.
static double exact_mean(params q, uint d) {
  return q.t < d / 2.0 ? (d / 2.0 - q.t) + lower_moment(q.t, d, 1) : lower_moment(d - q.t, d, 1);
}

// For t < d/2, f = (S - t) + B with B = (t - S)_+ and (S - t) B = -B^2, so that
// Var f = Var S - E B^2 - (E B)^2 - 2 (d/2 - t) E B: E f^2 - (E f)^2 would cancel there.
static double exact_variance(params q, uint d) {
  const double s = fmin(q.t, d - q.t);
  const double mean = lower_moment(s, d, 1), square = 2 * lower_moment(s, d, 2);
  return q.t < d / 2.0 ? d / 12.0 - square - mean * (mean + (d - 2 * q.t)) : square - mean * mean;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += points_next(p) - R(0.5);
  const real excess = (sum - c[0]) - c[1];
  return select_real(excess < R(0.0), R(0.0), excess);
}
#endif
