// gauss-ridge-cos: cos(sum_j quantile(x_j) / sqrt(d)): the same Gaussian law, and so the same moments, at
// every d. Ridge functions of Hoyt & Owen (2020).
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = 1 / (M_PI * sqrt((double)d)); }

static double exact_mean(params q, uint d) { return exp(-0.5); }

// (1 + e^-2) / 2 - e^-1 = (1 - e^-1)^2 / 2
static double exact_variance(params q, uint d) { return expm1(-1.0) * expm1(-1.0) / 2; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) sum += normal_quantile(points_next(p));
  return cospi(c[0] * sum);
}
#endif
