// internal-layer-tanh: tanh((x - 1/3) / eps), a layer of width eps at a place that no dyadic point meets: a jump to
// point sets with N eps < 1, smooth beyond.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = 1 / (3 * q.eps); }

// ln cosh y = y + ln(1 + exp(-2y)) - ln 2 for y >= 0: cosh y itself overflows from y = 711 on.
static double left_tail(params q) { return q.eps * log1p(exp(-2.0 / 3 / q.eps)); }
static double right_tail(params q) { return q.eps * log1p(exp(-4.0 / 3 / q.eps)); }

static double exact_mean(params q, uint d) { return 1.0 / 3 + right_tail(q) - left_tail(q); }

// int tanh^2 = 1 - eps (tanh(2/3 / eps) + tanh(1/3 / eps))
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return (1 - mean) * (1 + mean) - q.eps * (tanh(2.0 / 3 / q.eps) + tanh(1.0 / 3 / q.eps));
}

static double exact_mean_abs(params q, uint d) { return 1 - 2 * M_LN2 * q.eps + right_tail(q) + left_tail(q); }

static double exact_variation(params q, uint d) { return tanh(2.0 / 3 / q.eps) + tanh(1.0 / 3 / q.eps); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  // 3x - 1 rounds once; x - 1/3 would have the error of 1/3 in it, which eps magnifies.
  return tanh(c[0] * fma(R(3.0), points_next(p), R(-1.0)));
}
#endif
