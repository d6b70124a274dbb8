// cancel-1mcos: (1 - cos(h x)) / h^2, in the naive form an absolute error of u / h^2, in the stable one
// 2 sin^2(h x / 2) / h^2.
#ifdef KOKSMA_EXACT
// sum (-1)^k h^2k / (2k + 3)!
static double exact_mean(params q, uint d) {
  double term = 1.0 / 6, sum = 0;
  for (uint k = 0; k < 12; ++k) {
    sum += term;
    term *= -q.h * q.h / ((2 * k + 4) * (2 * k + 5));
  }
  return sum;
}

// (1 - cos z)^2 = sum_(k >= 2) (-1)^k z^2k (4^k / 2 - 2) / (2k)!, z^2k of mean h^2k / (2k + 1)
static double exact_variance(params q, uint d) {
  double term = 1.0 / 24, square = 0, power = 16;
  for (uint k = 2; k < 16; ++k) {
    square += term * (power / 2 - 2) / (2 * k + 1);
    term *= -q.h * q.h / ((2 * k + 1) * (2 * k + 2));
    power *= 4;
  }
  const double mean = exact_mean(q, d);
  return square - mean * mean;
}

static double exact_variation(params q, uint d) {
  const double s = sin(q.h / 2) / q.h;
  return 2 * s * s;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real h = q.h, x = points_next(p);
#if KOKSMA_FORM_NAIVE
  // The cosine as 1 - 2 sin^2: rounded like any number near 1, whatever the device's cos. OpenCL lets that err
  // by 4 ulp, and where it errs to one side (Intel, 2026.2: 0.7 of 2^-24 below 1) its bias would be measured.
  const real s = sin(R(0.5) * h * x), cosine = R(1.0) - R(2.0) * s * s;
  return (R(1.0) - cosine) / (h * h);
#else
  const real s = sin(R(0.5) * h * x) / h;
  return R(2.0) * s * s;
#endif
}
#endif
