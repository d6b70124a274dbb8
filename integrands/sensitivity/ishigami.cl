// ishigami: sin X_1 + a sin^2 X_2 + b X_3^4 sin X_1, X = -pi + 2 pi x. Ishigami & Homma (1990).
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = q.b * (M_PI * M_PI) * (M_PI * M_PI);
}

static double exact_mean(params q, uint d) { return q.a / 2; }

static double exact_variance(params q, uint d) {
  const double b = q.b * (M_PI * M_PI) * (M_PI * M_PI);
  return q.a * q.a / 8 + b / 5 + b * b / 18 + 0.5;
}
#else
// sin X = sinpi(2x - 1), whose argument is exact on the coordinate grid.
static inline real integrand(points *p, params q, coefficients c) {
  const real sin_1 = sinpi(R(2.0) * points_next(p) - R(1.0));
  const real sin_2 = sinpi(R(2.0) * points_next(p) - R(1.0));
  const real t = R(2.0) * points_next(p) - R(1.0);
  return fma(sin_1, fma((real)c[0], t * t * (t * t), R(1.0)), q.a * (sin_2 * sin_2));
}
#endif
