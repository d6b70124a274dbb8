// cancel-expm1: (exp(h x) - 1) / h, in the naive form an absolute error of u / h, in the stable one expm1.
#ifdef KOKSMA_EXACT
// sum h^k / (k + 2)!
static double exact_mean(params q, uint d) {
  double term = 0.5, sum = 0;
  for (uint k = 0; k < 24; ++k) {
    sum += term;
    term *= q.h / (k + 3);
  }
  return sum;
}

// Var exp(h x) = exp(h) (sinh(y) / y)^2 (y coth y - 1), y = h / 2, with the series sinh(y) / y = 1 + sum y^2k / (2k+1)!
// and (y cosh y - sinh y) / y^3 = sum 2k y^(2k-2) / (2k+1)!.
static double exact_variance(params q, uint d) {
  const double y = q.h / 2;
  double term = 1, ratio = 1, rise = 0;
  for (uint k = 1; k <= 10; ++k) {
    rise += 2 * k * term / (2 * k * (2 * k + 1));
    term *= y * y / (2 * k * (2 * k + 1));
    ratio += term;
  }
  return exp(q.h) * ratio * rise / 4;
}

static double exact_variation(params q, uint d) { return expm1(q.h) / q.h; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real h = q.h, x = points_next(p);
#if KOKSMA_FORM_NAIVE
  return (exp(h * x) - R(1.0)) / h;
#else
  return expm1(h * x) / h;
#endif
}
#endif
