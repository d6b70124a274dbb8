// gauss-ridge-jump: 1{sum_j quantile(x_j) / sqrt(d) > tau}: the same Gaussian law, and so the same
// moments, at every d. Ridge functions of Hoyt & Owen (2020); with tau = 3 ... 6 a rare event.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = q.tau * sqrt((double)d); }

static double exact_mean(params q, uint d) { return erfc(q.tau * M_SQRT1_2) / 2; }

static double exact_variance(params q, uint d) {
  return erfc(q.tau * M_SQRT1_2) / 2 * (erfc(-q.tau * M_SQRT1_2) / 2);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += normal_quantile(points_next(p));
  return select_real(sum > (real)c[0], R(1.0), R(0.0));
}
#endif
