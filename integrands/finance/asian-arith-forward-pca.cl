// asian-arith-forward-pca: asian-arith-forward with the path built from the principal components of its covariance,
// the largest first (Acworth, Broadie & Glasserman 1998). Every price depends on every normal: d^2 operations, and the
// coefficients are one table of 8 d numbers: sin(m pi / (2 d + 1)), m = 0 ... 4 d + 1, d amplitudes, one factor.
#ifdef KOKSMA_EXACT
// Eigenpairs of min(i, l) t / d (Glasserman 2003, section 3.1): sqrt(t / d) / (2 sin u), 2 sin(2 i u) / sqrt(2 d + 1)
// with u = (2 j + 1) pi / (2 (2 d + 1)), j from 0.
static double table_entry(params q, uint d, uint at) {
  const uint sines = 4 * d + 2, whole = 2 * d + 1;
  if (at < sines) return sinpi((double)at / whole);
  if (at < sines + d) return q.sigma * sqrt(q.t / d / whole) / sinpi((2 * (at - sines) + 1) / (2.0 * whole));
  return q.s0 * exp(-q.r * q.t) / d;
}

static void integrand_setup(params q, uint d, uint j, double *c) {
  for (uint k = 0; k < 8; ++k) c[k] = table_entry(q, d, 8 * j + k);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  const uint sines = 4 * KOKSMA_DIM + 2;
  real z[KOKSMA_DIM];
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) z[j] = c[sines + j] * normal_quantile(points_next(p));

  const scalar drift = (q.r - q.sigma * q.sigma / 2) * q.t / KOKSMA_DIM;
  real sum = R(0.0);
  for (uint i = 1; i <= KOKSMA_DIM; ++i) {
    real path = drift * (scalar)i;
    uint at = i;  // (2 j + 1) i modulo the period of the sine
    for (uint j = 0; j < KOKSMA_DIM; ++j) {
      path = fma((real)c[at], z[j], path);
      at = min(at + 2 * i, at + 2 * i - sines);  // unsigned: the difference wraps where it is below 0
    }
    sum += exp(path);
  }
  return c[sines + KOKSMA_DIM] * sum;
}
#endif
