// halfspace-indicator: 1{sum_j a_j x_j <= t}, a_1 = 1 and a_j = P_j / P_(j+2), P_j the j-th prime (3/7,
// 5/11, 7/13, ...): a cut that no point set is aligned with.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
__constant uint koksma_halfspace_primes[18] = {2,  3,  5,  7,  11, 13, 17, 19, 23,
                                               29, 31, 37, 41, 43, 47, 53, 59, 61};

static double slope(uint j) {
  return j == 0 ? 1 : (double)koksma_halfspace_primes[j] / koksma_halfspace_primes[j + 2];
}

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = slope(j); }

// Pairs (value, its rounding error): Dekker, Numer. Math. 18 (1971), with fma. The sum over subsets
// alternates; in pairs up to 17 digits may cancel.
static double2 pair_sum(double2 a, double2 b) {
  const double s = a.x + b.x, t = s - a.x;
  const double e = (a.x - (s - t)) + (b.x - t) + (a.y + b.y);
  return (double2)(s + e, e - ((s + e) - s));
}

static double2 pair_product(double2 a, double2 b) {
  const double s = a.x * b.x, e = fma(a.x, b.x, -s) + (a.x * b.y + a.y * b.x);
  return (double2)(s + e, e - ((s + e) - s));
}

// (1 / (d! prod a)) sum over subsets S of (-1)^|S| max(t - sum_S a, 0)^d.
static double volume_below(double2 t, uint d) {
  double2 sum = (double2)(0, 0);
  for (uint subset = 0; subset < 1u << d; ++subset) {
    double2 s = t;
    for (uint j = 0; j < d; ++j)
      if (subset >> j & 1) s = pair_sum(s, (double2)(-slope(j), 0));
    if (!(s.x > 0)) continue;
    double2 power = s;
    for (uint k = 1; k < d; ++k) power = pair_product(power, s);
    sum = pair_sum(sum, popcount(subset) % 2 == 0 ? power : -power);
  }
  double scale = 1;
  for (uint j = 0; j < d; ++j) scale *= (j + 1) * slope(j);
  return sum.x / scale;
}

// Where t is cut from the far corner; the smaller of both sides is computed, by symmetry.
static double2 from_far_corner(params q, uint d) {
  double2 rest = (double2)(-q.t, 0);
  for (uint j = 0; j < d; ++j) rest = pair_sum(rest, (double2)(slope(j), 0));
  return rest;
}

static double smaller_side(params q, uint d) {
  const double2 rest = from_far_corner(q, d);
  const double2 t = q.t <= rest.x ? (double2)(q.t, 0) : rest;
  return t.x > 0 ? volume_below(t, d) : 0;
}

static double exact_mean(params q, uint d) {
  const double side = smaller_side(q, d);
  return q.t <= from_far_corner(q, d).x ? side : 1 - side;
}

static double exact_variance(params q, uint d) {
  const double side = smaller_side(q, d);
  return side * (1 - side);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum = fma((real)c[j], points_next(p), sum);
  return select_real(sum <= (real)q.t, R(1.0), R(0.0));
}
#endif
