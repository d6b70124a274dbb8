// diag-log: -ln|x_1 - x_2|, singular along the diagonal. |x_1 - x_2| = t has the density 2 (1 - t). Points
// on the diagonal give infinity.
#ifdef KOKSMA_EXACT
// E (ln t)^2 = 7/2
static double exact_variance(params q, uint d) { return 1.25; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
  return -log(fabs(x - points_next(p)));
}
#endif
