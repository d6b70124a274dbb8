// logsumexp: ln(exp(c x_1) + exp(c x_2)), the smooth maximum. The naive form overflows from c x = 709.8 (fp64) or 88.7
// (fp32) on.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// f = c M + g, M = max(x_1, x_2), g = ln(1 + exp(-c t)) with t = |x_1 - x_2| of density 2 (1 - t) and E(M | t) =
// (1 + t) / 2. E g, 2 Cov(c M, g) and E g^2, in panels of length 1 of s = c t as far as g is above 1e-20.
static void corrections(double c, double *mean, double *covariance, double *square) {
  const double end = fmin(c, 46.0);
  const uint panels = (uint)ceil(end);
  *mean = *covariance = *square = 0;
  for (uint panel = 0; panel < panels; ++panel) {
    for (uint k = 0; k < 16; ++k) {
      double y, weight;
      legendre_16(k, end / panels, &y, &weight);
      const double s = panel * (end / panels) + y, t = s / c, g = log1p(exp(-s));
      weight *= 2 * (1 - t) / c;
      *mean += weight * g;
      *covariance += weight * c * (t - 1.0 / 3) * g;
      *square += weight * g * g;
    }
  }
}

static double exact_mean(params q, uint d) {
  double mean, covariance, square;
  corrections(q.c, &mean, &covariance, &square);
  return 2 * q.c / 3 + mean;
}

static double exact_variance(params q, uint d) {
  double mean, covariance, square;
  corrections(q.c, &mean, &covariance, &square);
  return q.c * q.c / 18 + covariance + (square - mean * mean);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = (real)q.c * points_next(p), y = (real)q.c * points_next(p);
#if KOKSMA_FORM_NAIVE
  return log(exp(x) + exp(y));
#else
  return fmax(x, y) + log1p(exp(-fabs(x - y)));
#endif
}
#endif
