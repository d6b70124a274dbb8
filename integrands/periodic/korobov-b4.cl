// korobov-b4: prod_j (1 - g_j (2 pi)^4 / 24 B_4(x_j)), g_j = scale j^-power, B_4 = (x (1 - x))^2 - 1/30; the second
// term is g_j times the sum of e^(2 pi i h x) / h^4 over h != 0 (DLMF 24.8.1). The error of an unshifted lattice is
// P_4, the sum over its dual lattice (Sloan & Joe 1994).
#ifdef KOKSMA_EXACT
#define TWO_PI_FOURTH_24 64.9393940226682914909602  // (2 pi)^4 / 24

static double gamma_of(params q, uint j) { return q.scale / pow((double)(j + 1), q.power); }

// With y = x (1 - x) a factor is 1 + c / 30 - c y^2.
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = -gamma_of(q, j) * TWO_PI_FOURTH_24;
  c[1] = 1 + gamma_of(q, j) * (TWO_PI_FOURTH_24 / 30);
}

static double exact_mean(params q, uint d) { return 1; }

// prod (1 + 2 zeta(8) g^2) - 1, 2 zeta(8) = pi^8 / 4725, without a subtraction, from the small terms up.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = d; j-- > 0;) {
    const double g = gamma_of(q, j);
    variance += (1 + variance) * (g * g * 2.00815471239588867875737047702);
  }
  return variance;
}

// With c = (2 pi)^4 g / 24 and x = 1/2 + t a factor is negative for |t| < s, where (1/4 - s^2)^2 = 1/30 + 1/c: the
// integral of its modulus is 1 + 4 c (s^3 / 3 - 4 s^5 / 5).
static double exact_mean_abs(params q, uint d) {
  double product = 1;
  for (uint j = 0; j < d; ++j) {
    const double c = gamma_of(q, j) * TWO_PI_FOURTH_24;
    if (!(c * 7 > 240)) continue;
    const double square = (7.0 / 240 - 1 / c) / (0.25 + sqrt(1.0 / 30 + 1 / c));
    product *= 1 + 4 * c * pow(square, 1.5) * (1.0 / 3 - 0.8 * square);
  }
  return product;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from 1 + c / 30 by c / 16 and rises again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j) {
    const double c = gamma_of(q, j) * TWO_PI_FOURTH_24;
    add_variation_factor(1 + c / 30, c / 8, &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    const real y = x * (R(1.0) - x);
    product *= fma((real)c[2 * j], y * y, (real)c[2 * j + 1]);
  }
  return product;
}
#endif
