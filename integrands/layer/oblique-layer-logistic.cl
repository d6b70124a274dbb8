// oblique-layer-logistic: 1 / (1 + exp(-(S - t) / eps)), S = sum_j x_j, t = (d + 2) / 3: a layer of width eps along an
// oblique plane, a jump to point sets with N^(1/d) eps < 1.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = 1 / (3 * q.eps); }

// Density of S (Irwin and Hall) by the recursion of B-splines, all terms positive (C. de Boor, A Practical Guide to
// Splines, 1978, chapter X).
static double density_of_sum(double s, uint d) {
  double b[17];  // b[k]: spline of the present order on [k, ...]
  for (uint k = 0; k < d; ++k) b[k] = s >= k && s < k + 1 ? 1 : 0;
  for (uint order = 2; order <= d; ++order)
    for (uint k = 0; k + order <= d; ++k) b[k] = ((s - k) * b[k] + (k + order - s) * b[k + 1]) / (order - 1);
  return b[0];
}

// E (f - centre)^power over the law of S, power 1 or 2. Panels end at the integers, where the density has its knots,
// and double in length away from the layer: each is as far from the poles t +- i pi eps as it is long.
static double moment(params q, uint d, double centre, uint power) {
  const double t = (d + 2) / 3.0;
  double sum = 0;
  for (double from = 0; from < d;) {
    const double away = fabs(from - t);
    double to = from < t ? (away > 2 * q.eps ? t - away / 2 : t) : from + fmax(2 * q.eps, away);
    to = fmin(to, floor(from) + 1);
    for (uint k = 0; k < 16; ++k) {
      double y, weight;
      legendre_16(k, to - from, &y, &weight);
      const double z = ((from - t) + y) / q.eps, e = exp(-fabs(z));
      const double value = (z > 0 ? 1 : e) / (1 + e) - centre;
      sum += weight * density_of_sum(from + y, d) * (power == 1 ? value : value * value);
    }
    from = to;
  }
  return sum;
}

static double exact_mean(params q, uint d) { return moment(q, d, 0, 1); }
static double exact_variance(params q, uint d) { return moment(q, d, exact_mean(q, d), 2); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  // S with the rounding errors of its sum, which eps would magnify: Knuth, The Art of Computer Programming 2, section
  // 4.2.2, theorem B.
  real high = R(0.0), low = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    const real next = high + x, added = next - high;
    low += (high - (next - added)) + (x - added);
    high = next;
  }
  const real z = c[0] * fma(R(3.0), low, fma(R(3.0), high, -(real)(scalar)(KOKSMA_DIM + 2)));
  const real e = exp(-fabs(z));  // never overflows
  return select_real(z > R(0.0), R(1.0), e) / (R(1.0) + e);
}
#endif
