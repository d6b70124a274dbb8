// gauss-ridge-kink: max(sum_j quantile(x_j) / sqrt(d) - tau, 0): the same Gaussian law, and so the same
// moments, at every d. Ridge functions of Hoyt & Owen (2020).
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = 1 / sqrt((double)d); }

static double normal_density(double t) { return 0.398942280401432677940 * exp(-t * t / 2); }

static double normal_upper(double t) { return erfc(t * M_SQRT1_2) / 2; }

// phi(tau) - tau Phi(-tau); cancels like 1 / tau^2 in the upper tail, hence the limit on tau.
static double exact_mean(params q, uint d) { return normal_density(q.tau) - q.tau * normal_upper(q.tau); }

// E f^2 = (1 + tau^2) Phi(-tau) - tau phi(tau)
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return (1 + q.tau * q.tau) * normal_upper(q.tau) - q.tau * normal_density(q.tau) - mean * mean;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += normal_quantile(points_next(p));
  const real excess = fma(sum, (real)c[0], -(real)q.tau);
  return select_real(excess < R(0.0), R(0.0), excess);
}
#endif
