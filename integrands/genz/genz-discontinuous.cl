// genz-discontinuous: exp(sum_j a_j x_j) 1{x_1 <= u1, x_2 <= u2}, a_j = h (2j - 1) / d^2.
// Genz (1984), family 6. Only x_1 and x_2 are cut (at d = 1 only x_1); Burkardt's TESTPACK cuts every
// coordinate, which is another function.
#ifdef KOKSMA_EXACT
static double a_of(params q, uint d, uint j) { return q.h * (2.0 * j + 1) / ((double)d * d); }

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = a_of(q, d, j); }

static double end_of(params q, uint j) { return j == 0 ? q.u1 : j == 1 ? q.u2 : 1; }

// Mean of exp(2ax) 1{x <= u} over the squared mean of exp(ax) 1{x <= u}, minus 1. With y = au/2 it is
// y coth(y) / u - 1 = (y coth(y) - 1) / u + (1 - u) / u, and y cosh(y) - sinh(y) has a series without
// signs.
static double relative_variance_of(double a, double u) {
  const double y = a * u / 2;
  double coth_excess = y / tanh(y) - 1;
  if (y < 1) {
    double term = y * y * y / 6, sum = 0;
    for (uint k = 1; k < 12; ++k) {
      sum += 2 * k * term;
      term *= y * y / ((2.0 * k + 2) * (2.0 * k + 3));
    }
    coth_excess = sum / sinh(y);
  }
  return (coth_excess + (1 - u)) / u;
}

static double exact_mean(params q, uint d) {
  // Factor u exp(y) sinh(y) / y, y = au/2: exponents are summed, so that rounding does not pile up.
  double exponent = 0, logarithm = 0, ends = 1;
  for (uint j = 0; j < d; ++j) {
    const double y = a_of(q, d, j) * end_of(q, j) / 2;
    double term = y * y / 6, sinch_excess = 0;
    for (uint k = 1; k < 12; ++k) {
      sinch_excess += term;
      term *= y * y / ((2.0 * k + 2) * (2.0 * k + 3));
    }
    exponent += y;
    logarithm += y < 1 ? log1p(sinch_excess) : log(sinh(y) / y);
    ends *= end_of(q, j);
  }
  return ends * exp(exponent + logarithm);
}

// mean^2 (prod (1 + v_j / m_j^2) - 1), the bracket built up term by term without a subtraction.
static double exact_variance(params q, uint d) {
  double excess = 0;
  for (uint j = 0; j < d; ++j) excess += relative_variance_of(a_of(q, d, j), end_of(q, j)) * (1 + excess);
  const double mean = exact_mean(q, d);
  return mean * mean * excess;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor rises to exp(a u) and, where it is cut before 1, falls to 0.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double u = end_of(q, j), rise = expm1(a_of(q, d, j) * u);
    const double jump = u < 1 ? 1 + rise : 0;
    add_variation_factor(1 + rise - jump, rise + jump, &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real x = points_next(p);
  real sum = c[0] * x;
  real inside = select_real(x <= (real)q.u1, R(1.0), R(0.0));
  KOKSMA_UNROLL
  for (uint j = 1; j < KOKSMA_DIM; ++j) {
    x = points_next(p);
    sum = fma((real)c[j], x, sum);
    if (j == 1) inside = select_real(x <= (real)q.u2, inside, R(0.0));
  }
  return inside * exp(sum);
}
#endif
