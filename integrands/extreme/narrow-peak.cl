// narrow-peak: prod_j exp(-(x_j - m_j)^2 / (2 sigma^2)) / (sigma sqrt(2 pi)), m = (1/3, 1/pi, 3/7): points that miss the
// peak return 0 with a sample variance of 0.
#ifdef KOKSMA_EXACT
static double peak(uint j) { return j == 0 ? 1.0 / 3 : (j == 1 ? M_1_PI : 3.0 / 7); }

// A peak as a number that fp32 holds and the rest: x less the former is exact near the peak. The rest of the double is
// added, for sigma magnifies it. The factor of all dimensions comes with the first.
static void integrand_setup(params q, uint d, uint j, double *c) {
  const double rest = j == 0 ? 1.850371707708594e-17 : (j == 1 ? -1.9678676675182486e-17 : 2.3790493384824782e-17);
  c[0] = (float)peak(j);
  c[1] = (peak(j) - c[0]) + rest;
  c[2] = M_SQRT1_2 / q.sigma;
  c[3] = pown(1 / (q.sigma * sqrt(2 * M_PI)), (int)d);
}

static double mass(double m, double width) { return (erf(m / width) + erf((1 - m) / width)) / 2; }

static double exact_mean(params q, uint d) {
  double mean = 1;
  for (uint j = 0; j < d; ++j) mean *= mass(peak(j), M_SQRT2 * q.sigma);
  return mean;
}

// The square of one factor is a peak of width sigma / sqrt(2), of height 1 / (2 sigma sqrt(pi)).
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  double square = 1;
  for (uint j = 0; j < d; ++j) square *= mass(peak(j), q.sigma) / (2 * q.sigma * sqrt(M_PI));
  return square - mean * mean;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real exponent = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real z = ((points_next(p) - c[4 * j]) - c[4 * j + 1]) * c[4 * j + 2];
    exponent = fma(-z, z, exponent);
  }
  return c[3] * exp(exponent);
}
#endif
