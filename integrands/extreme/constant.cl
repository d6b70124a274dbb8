// constant: every sample is the same number: error and variance 0, a stagnating sum shows at once.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return q.value; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) points_next(p);
  return (real)q.value;
}
#endif
