// walsh-alias: the Rademacher function r_m(x) = (-1)^floor(2^(m+1) x), digit m + 1 of x: 2^m points of an unscrambled net
// all have the digit 0, so their mean is 1 where I = 0; 2^(m+1) points of any net give exactly 0.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = ldexp(1.0, (int)q.m + 1); }

// Other m than integers are not covered: the last cell would be cut.
static double exact_mean(params q, uint d) { return q.m == floor(q.m) ? 0 : NAN; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  // Half of the cell's number tells odd from even; a scale by a power of 2 is exact.
  const real half_cell = R(0.5) * floor(c[0] * points_next(p));
  return select_real(floor(half_cell) < half_cell, R(-1.0), R(1.0));
}
#endif
