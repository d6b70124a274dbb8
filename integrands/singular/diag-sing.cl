// diag-sing: |x_1 - x_2|^-a, singular along the diagonal, where no theory of growth at the boundary
// helps. |x_1 - x_2| = t has the density 2 (1 - t). Points on the diagonal give infinity.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return 2 / ((1 - q.a) * (2 - q.a)); }

// E f^2 - I^2 with E f^2 = 1 / ((1 - 2a) (1 - a)), on one denominator: no subtraction left.
static double exact_variance(params q, uint d) {
  const double a = q.a;
  if (a >= 0.5) return INFINITY;
  const double b = (1 - a) * (2 - a);
  return a * a * (5 - a) / ((1 - 2 * a) * b * b);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
  return pow(fabs(x - points_next(p)), -(real)q.a);
}
#endif
