// korobov-b2: prod_j (1 + g_j 2 pi^2 B_2(x_j)), g_j = scale j^-power, B_2 = x^2 - x + 1/6; 2 pi^2 B_2 is the sum of
// e^(2 pi i h x) / h^2 over h != 0 (DLMF 24.8.1). With g_j as weights it is the reproducing kernel of the Korobov
// space alpha = 2 at 0: the error of an unshifted lattice is P_2, the sum over its dual lattice (Sloan & Joe 1994).
#ifdef KOKSMA_EXACT
#define TWO_PI_SQUARED 19.73920880217871723767

static double gamma_of(params q, uint j) { return q.scale / pow((double)(j + 1), q.power); }

// With y = x - 1/2 a factor is 1 - g 2 pi^2 / 12 + g 2 pi^2 y^2.
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = gamma_of(q, j) * TWO_PI_SQUARED;
  c[1] = 1 - gamma_of(q, j) * (TWO_PI_SQUARED / 12);
}

static double exact_mean(params q, uint d) { return 1; }

// prod (1 + 2 zeta(4) g^2) - 1, 2 zeta(4) = pi^4 / 45, without a subtraction, from the small terms up.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = d; j-- > 0;) {
    const double g = gamma_of(q, j);
    variance += (1 + variance) * (g * g * 2.16464646742227638303200739308);
  }
  return variance;
}

// With c = 2 pi^2 g a factor is c (y^2 - s^2), s^2 = 1/12 - 1/c, and negative for |y| < s: the integral of its
// modulus is 1 + 8 c s^3 / 3.
static double exact_mean_abs(params q, uint d) {
  double product = 1;
  for (uint j = 0; j < d; ++j) {
    const double c = gamma_of(q, j) * TWO_PI_SQUARED;
    if (c > 12) product *= 1 + 8 * c / 3 * pow((c - 12) / (12 * c), 1.5);
  }
  return product;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from 1 + c / 6 by c / 4 and rises again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double c = gamma_of(q, j) * TWO_PI_SQUARED;
    add_variation_factor(1 + c / 6, c / 2, &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real y = points_next(p) - R(0.5);
    product *= fma((real)c[2 * j], y * y, (real)c[2 * j + 1]);
  }
  return product;
}
#endif
