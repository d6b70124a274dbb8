// arcsine: 1 / (pi sqrt(x (1 - x))), the density of the arcsine law: mean 1, and the variance is just
// infinite (logarithmically). x = 0 gives infinity.
#ifdef KOKSMA_EXACT
static double exact_variance(params q, uint d) { return INFINITY; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
  return R(0.31830988618379067) / sqrt(x * (R(1.0) - x));  // 1 / pi
}
#endif
