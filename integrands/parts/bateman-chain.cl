// bateman-chain: the decay chain A -> B -> C with k1 = 1/2 + x1, k2 = 10^(7 x2 - 1), from pure A: the exact values of
// C(1) = 1 - exp(-k1) - k1 (exp(-k1) - exp(-k2)) / (k2 - k1) (H. Bateman, Proc. Cambridge Philos. Soc. 15 (1910)).
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

static double chain_product(double k1, double k2) {
  const double gap = k2 - k1;
  return -expm1(-k1) - k1 * exp(-k1) * (gap == 0 ? 1 : -expm1(-gap) / gap);
}

// E C - centre, or E (C - centre)^2: 16 points in x1, and in x2 in each quarter of a decade of k2.
static double chain_moment(double centre, bool squared) {
  double sum = 0;
  for (uint part = 0; part < 28; ++part)
    for (uint i = 0; i < 16; ++i) {
      double y, weight, row = 0;
      legendre_16(i, 0.25, &y, &weight);
      const double k2 = pow(10.0, part * 0.25 + y - 1);
      for (uint k = 0; k < 16; ++k) {
        double x, inner;
        legendre_16(k, 1, &x, &inner);
        const double difference = chain_product(0.5 + x, k2) - centre;
        row += inner * (squared ? difference * difference : difference);
      }
      sum += weight / 7 * row;
    }
  return sum;
}

static double exact_mean(params q, uint d) { return chain_moment(0, false); }
static double exact_variance(params q, uint d) { return chain_moment(chain_moment(0, false), true); }
#endif
