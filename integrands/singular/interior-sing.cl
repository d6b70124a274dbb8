// interior-sing: |x - 1/3|^-a, a singularity inside the interval at a place that no dyadic point meets.
#ifdef KOKSMA_EXACT
// With probability c = 1/3 |x - c| is uniform on (0, c), else on (0, 1 - c): f = A B, A = u^-a for a
// uniform u, and B = c^-a or (1 - c)^-a.
static double exact_mean(params q, uint d) {
  return (pow(1.0 / 3, 1 - q.a) + pow(2.0 / 3, 1 - q.a)) / (1 - q.a);
}

// Var AB = Var A E B^2 + (E A)^2 Var B, all positive; c^-a - (1 - c)^-a = (1 - c)^-a (2^a - 1).
static double exact_variance(params q, uint d) {
  const double a = q.a;
  if (a >= 0.5) return INFINITY;
  const double square = (pow(1.0 / 3, 1 - 2 * a) + pow(2.0 / 3, 1 - 2 * a)) / ((1 - a) * (1 - a));
  const double rise = pow(2.0 / 3, -a) * expm1(a * M_LN2) / (1 - a);
  return square * (a * a / (1 - 2 * a)) + 2.0 / 9 * rise * rise;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  // 3x - 1 rounds once; x - 1/3 would have the error of 1/3 in it, which is large near the singularity.
  const real y = fabs(fma(R(3.0), points_next(p), R(-1.0)));
  return pow(y * R(0.33333333333333333), -(real)q.a);
}
#endif
