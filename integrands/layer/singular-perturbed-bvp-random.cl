// singular-perturbed-bvp-random: the solution of -eps u'' + u' = 1, u(0) = u(1) = 0, at x_1 for the random diffusion
// eps = 10^(5 x_2 - 6): boundary layers of widths from 1e-6 to 0.1 in one integral.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// E g(eps), with x_2 in 20 panels: exp(-1 / eps) turns on within the last ones.
static double mean_over_eps(double centre, uint power) {
  double sum = 0;
  for (uint panel = 0; panel < 20; ++panel) {
    for (uint k = 0; k < 16; ++k) {
      double y, weight;
      legendre_16(k, 0.05, &y, &weight);
      const double eps = exp10(5 * (0.05 * panel + y) - 6);
      const double away = bvp_mean(eps) - centre;
      sum += weight * (power == 1 ? away : away * away + bvp_variance(eps));
    }
  }
  return sum;
}

static double exact_mean(params q, uint d) { return mean_over_eps(0, 1); }
static double exact_variance(params q, uint d) { return mean_over_eps(exact_mean(q, d), 2); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
  // 1 / eps = 10^6 10^(-5 x_2)
  const real inverse = R(1000000.0) * exp(R(-11.512925464970228420) * points_next(p));
  return bvp_solution(x, inverse, exp(-inverse));
}
#endif
