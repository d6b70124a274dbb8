// simplex-indicator: 1{sum_j x_j <= t}, the volume of a cube cut by an oblique plane (Irwin-Hall
// distribution).
#ifdef KOKSMA_EXACT
// The larger of both tails never has more than d/2 + 1 integer shifts; 4096 is the entry's largest
// dimension.
#define KOKSMA_SIMPLEX_SHIFTS (4096 / 2 + 2)

// F_d(t) for 0 <= t <= d/2 by F_n(t) = (t F_(n-1)(t) + (n - t) F_(n-1)(t - 1)) / n (de Boor's recurrence
// for B-splines with integer knots, integrated): positive weights, where the alternating sum over k
// cancels.
static double lower_volume(double t, uint d) {
  double volume[KOKSMA_SIMPLEX_SHIFTS];
  if (!(t > 0)) return 0;
  const uint shifts = (uint)t + 1;  // F(t - k) vanishes from k = shifts on
  for (uint k = 0; k <= shifts; ++k) volume[k] = k < shifts ? 1 : 0;
  for (uint n = 1; n <= d; ++n)
    for (uint k = 0; k < shifts; ++k) {
      const double s = t - k;
      volume[k] = s >= n ? 1 : (s * volume[k] + (n - s) * volume[k + 1]) / n;
    }
  return volume[0];
}

// The smaller of both sides: the other one is 1 minus it by symmetry.
static double smaller_side(params q, uint d) { return lower_volume(fmin(q.t, d - q.t), d); }

static double exact_mean(params q, uint d) {
  return q.t <= d - q.t ? smaller_side(q, d) : 1 - smaller_side(q, d);
}

static double exact_variance(params q, uint d) { return smaller_side(q, d) * (1 - smaller_side(q, d)); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += points_next(p);
  return select_real(sum <= (real)q.t, R(1.0), R(0.0));
}
#endif
