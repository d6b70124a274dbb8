// keister: pi^(d/2) cos(|z| / sqrt 2), z = quantile(x): the integral of cos|t| exp(-|t|^2) over R^d.
// Keister (1996). pi^(d/2) leaves the fp32 range at d = 156; mean^2 leaves the fp64 range at d = 621.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = pow(M_PI, d / 2.0); }

// Pairs (value, its rounding error): Dekker, Numer. Math. 18 (1971), with fma. One double is too short
// near the zeros of the mean, and the recurrence below multiplies rounding errors by d.
static double2 pair_sum(double2 a, double2 b) {
  const double s = a.x + b.x, t = s - a.x;
  const double e = (a.x - (s - t)) + (b.x - t) + (a.y + b.y);
  return (double2)(s + e, e - ((s + e) - s));
}

static double2 pair_product(double2 a, double b) {
  const double s = a.x * b, e = fma(a.x, b, -s) + a.y * b;
  return (double2)(s + e, e - ((s + e) - s));
}

static double2 pair_quotient(double2 a, double b) {
  const double s = a.x / b, e = (fma(-s, b, a.x) + a.y) / b;
  return (double2)(s + e, e - ((s + e) - s));
}

// M = 1F1(d/2; 1/2; -1/4) (E cos(|z| / sqrt 2)), or with -1 (E cos(sqrt 2 |z|)) where `doubled`, upwards
// in a = d/2 by a (M(a+1) - M(a)) = (a - 1/2) (M(a) - M(a-1)) + z M(a)   (DLMF 13.3.1 with b = 1/2; the
// power series in z cancels). Starts: 1F1(1/2; 1/2; z) = e^z, whose left neighbour does not matter, and
// 1F1(0; 1/2; z) = 1, 1F1(1; 1/2; z).
static double2 kummer(uint d, bool doubled) {
  const double z = doubled ? -1 : -0.25;
  double2 value, rise;
  double a = d % 2 == 1 ? 0.5 : 1;
  if (d % 2 == 1) {
    value = doubled ? (double2)(0.36787944117144233, -1.2428753672788363e-17)
                    : (double2)(0.7788007830714049, -1.0231869534531498e-17);
    rise = (double2)(0, 0);
  } else {
    value = doubled ? (double2)(-0.07615901382553684, 6.571113832224942e-18)
                    : (double2)(0.5755636164979777, -1.0670620389025899e-17);
    rise = pair_sum(value, (double2)(-1, 0));
  }
  for (; a < d / 2.0; a += 1) {
    rise = pair_quotient(pair_sum(pair_product(rise, a - 0.5), pair_product(value, z)), a);
    value = pair_sum(value, rise);
  }
  return value;
}

static double exact_mean(params q, uint d) { return pow(M_PI, d / 2.0) * kummer(d, false).x; }

static double exact_variance(params q, uint d) {
  const double cosine = kummer(d, false).x;
  return pow(M_PI, (double)d) * ((1 + kummer(d, true).x) / 2 - cosine * cosine);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real z = normal_quantile(points_next(p));
    sum = fma(z, z, sum);
  }
  return c[0] * cospi(R(0.22507907903927651) * sqrt(sum));  // 1 / (pi sqrt 2)
}
#endif
