// poisson-kernel: prod_j (1 - rho^2) / (1 - 2 rho cos 2 pi x_j + rho^2), analytic and 1-periodic with the Fourier
// coefficients rho^|h|; a lattice's error at d = 1 is 2 rho^N / (1 - rho^N). Trefethen & Weideman (2014).
#ifdef KOKSMA_EXACT
// 1 - 2 rho cos 2t + rho^2 = (1 - rho)^2 + 4 rho sin^2 t, divided by 1 - rho^2: no cancellation at the peak.
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = (1 - q.rho) / (1 + q.rho);
  c[1] = 4 * q.rho / ((1 - q.rho) * (1 + q.rho));
}

static double exact_mean(params q, uint d) { return 1; }

// ((1 + rho^2) / (1 - rho^2))^d - 1, built up without a subtraction.
static double exact_variance(params q, uint d) {
  const double e = 2 * q.rho * q.rho / ((1 - q.rho) * (1 + q.rho));
  double variance = 0;
  for (uint j = 0; j < d; ++j) variance += (1 + variance) * e;
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from (1 + rho) / (1 - rho) by 4 rho / (1 - rho^2) and rises again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j)
    add_variation_factor((1 + q.rho) / (1 - q.rho), 8 * q.rho / ((1 - q.rho) * (1 + q.rho)), &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real s = sinpi(points_next(p));
    product *= fma(c[1] * s, s, (real)c[0]);
  }
  return R(1.0) / product;
}
#endif
