// expcos: prod_j e^(cos 2 pi x_j) / I_0(1): entire and 1-periodic, Fourier coefficients I_h(1) / I_0(1). One
// exponential of the sum of cosines. Trefethen & Weideman (2014).
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = d * 0.235914358507178648689; }  // ln I_0(1)

static double exact_mean(params q, uint d) { return 1; }

// (I_0(2) / I_0(1)^2)^d - 1, built up without a subtraction.
static double exact_variance(params q, uint d) {
  double variance = 0;
  for (uint j = 0; j < d; ++j) variance += (1 + variance) * 0.422142908351026336463540216905509731;
  return variance;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// A factor falls from e / I_0(1) to 1 / (e I_0(1)) and rises again.
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint j = 0; j < d; ++j)
    add_variation_factor(2.14703032142810096197, 3.7129227295200666604, &variation, &at_one);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += cospi(R(2.0) * points_next(p));
  return exp(sum - c[0]);
}
#endif
