// lattice-alias: cos(2 pi 2^m x): constant on a lattice of N = 2^k <= 2^m points, whose error is 1 unshifted and, with a
// random shift, 1/sqrt(2) in the root mean square at all those N, worse than Monte Carlo.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = ldexp(1.0, (int)q.m); }

// Other m than integers are not covered: the last period would be cut.
static double exact_mean(params q, uint d) { return q.m == floor(q.m) ? 0 : NAN; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real periods = c[0] * points_next(p);  // exact, and so is its fraction
  return cospi(R(2.0) * (periods - floor(periods)));
}
#endif
