// cauchy: tan(pi (x - 1/2)), the Cauchy law: there is no mean, and the mean of N independent samples has
// the law of one. Must not converge; any estimate of it is an artefact of the point set.
#ifdef KOKSMA_EXACT
static double exact_variance(params q, uint d) { return INFINITY; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  // -cot(pi x); the argument of tan would have to be rounded near its poles.
  const real x = points_next(p);
  return -cospi(x) / sinpi(x);
}
#endif
