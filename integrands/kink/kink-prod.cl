// kink-prod: prod_j |x_j - c_j| / m_j, c = 1/3 (j odd) and 1/pi (j even), m_j = E|x_j - c_j|: mean 1. Its kinks lie
// on axis-parallel planes at places that no base-2 net sees exactly.
#ifdef KOKSMA_EXACT
static double c_of(uint j) { return j % 2 == 0 ? 1.0 / 3 : M_1_PI; }

static double mean_of(double c) { return (c * c + (1 - c) * (1 - c)) / 2; }

// c in two parts, so that x - c keeps its relative accuracy; prod 1 / (4 m), as the device multiplies 4 |x - c|.
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = (float)c_of(j);
  c[1] = j % 2 == 0 ? fma(-3.0, c[0], 1.0) / 3 : (M_1_PI - c[0]) + -1.9678676675182486e-17;
  c[2] = pow(4 * mean_of(c_of(0)), -0.5 * (d + d % 2)) * pow(4 * mean_of(c_of(1)), -0.5 * (d - d % 2));
}

static double exact_mean(params q, uint d) { return 1; }

// prod (1 + Var g / m^2) - 1, built up term by term without a subtraction; E g^2 = (c^3 + (1-c)^3) / 3.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = 0; j < d; ++j) {
    const double c = c_of(j), m = mean_of(c);
    const double square = (c * c * c + (1 - c) * (1 - c) * (1 - c)) / 3;
    variance += (1 + variance) * ((square - m * m) / (m * m));
  }
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls by c / m and rises by (1 - c) / m.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j)
    add_variation_factor((1 - c_of(j)) / mean_of(c_of(j)), 1 / mean_of(c_of(j)), &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j)
    product *= R(4.0) * fabs((points_next(p) - c[3 * j]) - c[3 * j + 1]);
  return c[2] * product;
}
#endif
