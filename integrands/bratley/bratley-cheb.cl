// bratley-cheb: prod_i T_n(2 x_i - 1), n = (i mod 4) + 1, f_3 of Bratley, Fox & Niederreiter (1992): Chebyshev
// polynomials of degrees 2, 3, 4, 1, 2, ... T_3 is odd about 1/2, so the
// mean is 0 from d = 2 on.
#ifdef KOKSMA_EXACT
static uint degree_of(uint i) { return i % 4 + 1; }

static double exact_mean(params q, uint d) { return 0; }

// E T_n^2 = (1 + 1 / (1 - 4 n^2)) / 2 = (2 n^2 - 1) / (4 n^2 - 1)
static double exact_variance(params q, uint d) {
  double square = 1;
  for (uint i = 1; i <= d; ++i) {
    const double n = degree_of(i);
    square *= (2 * n * n - 1) / (4 * n * n - 1);
  }
  return square;
}

// E|T_n|, by the antiderivatives between the roots: 1/2, (2 sqrt 2 - 1) / 3, 5/8, and below for n = 4.
static double exact_mean_abs(params q, uint d) {
  const double a = sin(M_PI / 8), b = cos(M_PI / 8);  // the positive roots of T_4
  const double a3 = a * a * a, b3 = b * b * b;
  const double t4 = 2 * (1.6 * (a3 * a * a - b3 * b * b) - 8.0 / 3 * (a3 - b3) + (a - b)) - 1.0 / 15;
  const double means[4] = {0.5, (2 * M_SQRT2 - 1) / 3, 0.625, t4};
  double product = 1;
  for (uint i = 1; i <= d; ++i) product *= means[degree_of(i) - 1];
  return product;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// T_n runs n times between -1 and 1.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint i = 1; i <= d; ++i) add_variation_factor(1, 2.0 * degree_of(i), &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real y = R(2.0) * (points_next(p) - R(0.5));
    real t = fma(y + y, y, R(-1.0));                  // T_2
    if (j % 4 == 1) t = y * fma(t, R(2.0), R(-1.0));  // T_3 = y (2 T_2 - 1)
    if (j % 4 == 2) t = fma(t + t, t, R(-1.0));       // T_4 = 2 T_2^2 - 1
    if (j % 4 == 3) t = y;
    product *= t;
  }
  return product;
}
#endif
