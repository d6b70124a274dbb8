// genz-oscillatory: cos(2 pi w + sum_j a_j x_j), a_j = h (2j - 1) / d^2, so that sum a_j = h.
// Genz (1984), family 1. Computed as cospi(2w + sum (a_j / pi) x_j): the reduction of cospi is exact.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static double a_of(params q, uint d, uint j) { return q.h * (2.0 * j + 1) / ((double)d * d); }

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = a_of(q, d, j) / M_PI; }

// f = cos(theta + X) with theta the phase at the centre and X = sum a_j (x_j - 1/2), symmetric about 0.
static double theta_of(params q) { return 2 * M_PI * q.w + q.h / 2; }

// 1 - sin(y)/y; the Taylor series where the difference would cancel.
static double sinc_deficit(double y) {
  if (fabs(y) > 1) return 1 - sin(y) / y;
  double term = y * y / 6, sum = 0;
  for (uint k = 2; k < 12; ++k) {
    sum += term;
    term *= -y * y / ((2.0 * k) * (2.0 * k + 1));
  }
  return sum;
}

// E cos X = prod sin(a_j / 2) / (a_j / 2). A product keeps its digits where it is small, one minus the
// deficit where it is near 1.
static double exact_mean(params q, uint d) {
  double product = 1, deficit = 0;
  for (uint j = 0; j < d; ++j) {
    const double s = sinc_deficit(a_of(q, d, j) / 2);
    product *= 1 - s;
    deficit += s * (1 - deficit);
  }
  return cos(theta_of(q)) * (deficit > 0.5 ? product : 1 - deficit);
}

// Var cos(a (x - 1/2)) = (1 + sin(a)/a) / 2 - 2 (1 - cos a) / a^2; its Taylor series starts at a^4 / 720.
static double factor_variance(double a) {
  if (fabs(a) > 2) return (1 + sin(a) / a) / 2 - 2 * (1 - cos(a)) / (a * a);
  double power = a * a * a * a / 120, sum = 0;  // a^(2k) / (2k+1)!, with alternating sign
  for (uint k = 2; k < 14; ++k) {
    sum += power * (k - 1) / (2.0 * (k + 1));
    power *= -a * a / ((2.0 * k + 2) * (2.0 * k + 3));
  }
  return sum;
}

// cos^2(theta) Var cos X + sin^2(theta) (1 - E cos 2X) / 2. The textbook form 1/2 + cos(2 theta) E
// cos(2X) / 2 - mean^2 loses the small variances of high d; here every deficit and Var cos X are built up
// by dimensions from small terms.
static double exact_variance(params q, uint d) {
  double square = 0, twice = 0, variance = 0;  // 1 - (E cos X)^2, 1 - E cos 2X, Var cos X
  for (uint j = 0; j < d; ++j) {
    const double a = a_of(q, d, j), v = factor_variance(a), s = sinc_deficit(a);
    variance += v * (1 - square) + s / 2 * (twice - square);
    square += (v + s / 2) * (1 - square);
    twice += s * (1 - twice);
  }
  const double c = cos(theta_of(q)), s = sin(theta_of(q));
  return c * c * variance + s * s * twice / 2;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real phase = R(2.0) * q.w;
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) phase = fma((real)c[j], points_next(p), phase);
  return cospi(phase);
}
#endif
