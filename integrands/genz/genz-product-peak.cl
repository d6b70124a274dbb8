// genz-product-peak: prod_j 1 / (1 + a_j^2 (x_j - u_j)^2), a_j = h (2j - 1) / d^2 or all h, u_j = (2 + (j mod 7))
// / 11. Genz (1984), family 2, normalised to height 1: Genz' own form is this times prod a_j^2.
#ifdef KOKSMA_EXACT
static double a_of(params q, uint d, uint j) { return q.equal == 1 ? q.h : q.h * (2.0 * j + 1) / ((double)d * d); }
static double u_of(uint j) { return (2 + (j + 1) % 7) / 11.0; }
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = a_of(q, d, j);
  c[1] = u_of(j);
}

// int (1 + a^2 t^2)^-2 dt over [0, y]
static double square_integral(double a, double y) {
  return y / (1 + a * a * y * y) / 2 + atan(a * y) / (2 * a);
}

// One factor: the logarithm of its mean m, and its variance / m^2. A flat factor differs from 1 by less
// than the closed forms can tell, so there Gauss-Legendre integrates f - 1 and its spread on either side
// of u.
static void factor_moments(double a, double u, double *log_mean, double *relative_variance) {
  if (a > 2) {
    const double mean = (atan(a * (1 - u)) + atan(a * u)) / a;
    *log_mean = log(mean);
    *relative_variance = (square_integral(a, 1 - u) + square_integral(a, u)) / (mean * mean) - 1;
    return;
  }
  double shift = 0, spread = 0;
  for (uint pass = 0; pass < 2; ++pass)
    for (uint k = 0; k < 32; ++k) {
      double y, weight;
      legendre_16(k % 16, k < 16 ? u : 1 - u, &y, &weight);
      const double g = -(a * y) * (a * y) / (1 + (a * y) * (a * y));
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
    double below = a_of(q, d, j) * u_of(j), above = a_of(q, d, j) * (1 - u_of(j));
    below *= below;
    above *= above;
    add_variation_factor(1 / (1 + above), below / (1 + below) + above / (1 + above), &variation, &at_one);
  }
  return variation;
}
#else
// One division for eight factors: at a <= 100 each is below 7e3, so that the product stays below 1e31.
static inline real integrand(points *p, params q, coefficients c) {
  real value = R(1.0), product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real t = c[2 * j] * (points_next(p) - c[2 * j + 1]);
    product *= fma(t, t, R(1.0));
    if (j % 8 == 7 || j + 1 == KOKSMA_DIM) {
      value /= product;
      product = R(1.0);
    }
  }
  return value;
}
#endif
