// genz-gaussian: exp(-sum_j a_j^2 (x_j - u_j)^2), a_j = h (2j - 1) / d^2, u_j = (2 + (j mod 7)) / 11.
// Genz (1984), family 4.
#ifdef KOKSMA_EXACT
static double a_of(params q, uint d, uint j) { return q.h * (2.0 * j + 1) / ((double)d * d); }
static double u_of(uint j) { return (2 + (j + 1) % 7) / 11.0; }
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = a_of(q, d, j);
  c[1] = u_of(j);
}

// int exp(-a^2 (x - u)^2) dx over [0,1]
static double bell_integral(double a, double u) {
  const double half_sqrt_pi = 0.886226925452758013649;
  return half_sqrt_pi / a * (erf(a * (1 - u)) + erf(a * u));
}

// One factor: the logarithm of its mean m, and its variance / m^2. A flat factor differs from 1 by less
// than the closed forms can tell, so there Gauss-Legendre integrates f - 1 and its spread on either side
// of u.
static void factor_moments(double a, double u, double *log_mean, double *relative_variance) {
  if (a > 2) {
    const double mean = bell_integral(a, u);
    *log_mean = log(mean);
    *relative_variance = bell_integral(M_SQRT2 * a, u) / (mean * mean) - 1;
    return;
  }
  double shift = 0, spread = 0;
  for (uint pass = 0; pass < 2; ++pass)
    for (uint k = 0; k < 32; ++k) {
      double y, weight;
      legendre_16(k % 16, k < 16 ? u : 1 - u, &y, &weight);
      const double g = expm1(-(a * y) * (a * y));
      if (pass == 0) shift += weight * g;
      else spread += weight * (g - shift) * (g - shift);
    }
  *log_mean = log1p(shift);
  *relative_variance = spread / ((1 + shift) * (1 + shift));
}

static double exact_mean(params q, uint d) {
  double sum = 0;
  for (uint j = 0; j < d; ++j) {
    double log_mean, relative_variance;
    factor_moments(a_of(q, d, j), u_of(j), &log_mean, &relative_variance);
    sum += log_mean;
  }
  return exp(sum);
}

// mean^2 (prod (1 + v_j / m_j^2) - 1), the bracket built up term by term without a subtraction.
static double exact_variance(params q, uint d) {
  double excess = 0;
  for (uint j = 0; j < d; ++j) {
    double log_mean, relative_variance;
    factor_moments(a_of(q, d, j), u_of(j), &log_mean, &relative_variance);
    excess += relative_variance * (1 + excess);
  }
  const double mean = exact_mean(q, d);
  return mean * mean * excess;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor rises to 1 at u and falls again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double below = a_of(q, d, j) * u_of(j), above = a_of(q, d, j) * (1 - u_of(j));
    add_variation_factor(exp(-above * above), -expm1(-below * below) - expm1(-above * above), &variation,
                         &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real t = c[2 * j] * (points_next(p) - c[2 * j + 1]);
    sum = fma(t, t, sum);
  }
  return exp(-sum);
}
#endif
