// log-mean-prod: sum_j ln(1 + (x_j - 1/2) scale): the logarithm of a product that would leave the range of numbers at
// large d. Additive.
#ifdef KOKSMA_EXACT
// With y = x - 1/2, E y^2k = 4^-k / (2k + 1): E ln(1 + scale y) = - sum (scale / 2)^2k / (2k (2k + 1)).
static double mean_of_one(double scale) {
  double power = 1, sum = 0;
  for (uint k = 40; k > 0; --k) {
    power = pown(scale / 2, (int)(2 * k));
    sum -= power / (2 * k * (2 * k + 1));
  }
  return sum;
}

static double exact_mean(params q, uint d) { return d * mean_of_one(q.scale); }

// ln(1 + z)^2 = 2 sum_(n >= 2) (-z)^n H_(n-1) / n, H the harmonic numbers.
static double exact_variance(params q, uint d) {
  double harmonic = 1, sum = 0;
  for (uint k = 1; k <= 40; ++k) {
    sum += harmonic / k * pown(q.scale / 2, (int)(2 * k)) / (2 * k + 1);
    harmonic += 1.0 / (2 * k) + 1.0 / (2 * k + 1);
  }
  const double mean = mean_of_one(q.scale);
  return d * (sum - mean * mean);
}

// Additive: the variations of the terms.
static double exact_variation(params q, uint d) { return d * (log1p(q.scale / 2) - log1p(-q.scale / 2)); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  // Terms of both signs: their sum is compensated (Knuth, The Art of Computer Programming 2, section 4.2.2, theorem B).
  real high = R(0.0), low = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real term = log1p((real)q.scale * (points_next(p) - R(0.5)));
    const real next = high + term, added = next - high;
    low += (high - (next - added)) + (term - added);
    high = next;
  }
  return high + low;
}
#endif
