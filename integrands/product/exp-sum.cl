// exp-sum: exp(sum_j c_j x_j), c_j = scale / j^power. Smooth to all orders; the decay of c sets the effective
// dimension. The device sums c_j (x_j - 1/2): that sum stays small, so exp does not magnify its rounding, and
// the factor exp(sum c_j / 2) comes from the host.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static double c_of(params q, uint j) { return q.scale / pow((double)(j + 1), q.power); }

// a + b as (value, its rounding error): Dekker, Numer. Math. 18 (1971); Knuth's form.
static double2 pair_add(double2 a, double b) {
  const double s = a.x + b, t = s - a.x;
  return (double2)(s, a.y + ((a.x - (s - t)) + (b - t)));
}

// Both series have positive terms only: sinh(y) / y - 1 = sum y^2k / (2k+1)!, k >= 1, and
// (y cosh y - sinh y) / y = sum 2k y^2k / (2k+1)!. |y| <= 1 as |scale| <= 2.
static void sinh_series(double y, double *excess, double *rise) {
  double term = 1, e = 0, r = 0;
  for (uint k = 1; k <= 10; ++k) {
    term *= y * y / (2 * k * (2 * k + 1));
    e += term;
    r += 2 * k * term;
  }
  *excess = e;
  *rise = r;
}

static double2 half_sum(params q, uint d) {
  double2 sum = (double2)(0, 0);
  for (uint j = 0; j < d; ++j) sum = pair_add(sum, c_of(q, j) / 2);
  return sum;
}

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = c_of(q, j);
  c[1] = 1;
  if (j > 0) return;
  const double2 half_of_c = half_sum(q, d);
  c[1] = exp(half_of_c.x) * (1 + half_of_c.y);
}

// What leaves the range of fp64 is unknown rather than infinite or zero.
static double in_range(double value) { return isfinite(value) && fabs(value) >= DBL_MIN ? value : NAN; }

// prod (exp(c) - 1) / c = exp(sum (c / 2 + ln(sinh(c/2) / (c/2)))), the sum in pairs: its error is that of the mean.
static double exact_mean(params q, uint d) {
  double2 sum = half_sum(q, d);
  for (uint j = 0; j < d; ++j) {
    double excess, rise;
    sinh_series(c_of(q, j) / 2, &excess, &rise);
    sum = pair_add(sum, log1p(excess));
  }
  return in_range(exp(sum.x) * (1 + sum.y));
}

// E g^2 / (E g)^2 = (c/2) coth(c/2) for one factor; mean^2 (prod - 1), built up from the small terms.
static double exact_variance(params q, uint d) {
  if (q.scale == 0) return 0;
  double excess_of_product = 0;
  for (uint j = d; j-- > 0;) {
    double excess, rise;
    sinh_series(c_of(q, j) / 2, &excess, &rise);
    excess_of_product += (1 + excess_of_product) * (rise / (1 + excess));
  }
  const double mean = exact_mean(q, d);
  return in_range(mean * (mean * excess_of_product));
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j)
    add_variation_factor(exp(c_of(q, j)), fabs(expm1(c_of(q, j))), &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real exponent = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j)
    exponent = fma((real)(c[2 * j] * KOKSMA_CENTRED_UNIT), points_next_centred(p), exponent);
  return c[1] * exp(exponent);
}
#endif
