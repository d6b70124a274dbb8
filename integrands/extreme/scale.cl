// scale: 2^e (1 + x), at the ends of the range: denormal numbers (e = -140 in fp32, -1060 in fp64), and sums that overflow
// though their mean is a number (e = 120 at 2^8 samples in fp32, 1010 at 2^14 in fp64).
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = ldexp(1.0, (int)q.e); }

// Other e than integers are not covered.
static double exact_mean(params q, uint d) { return q.e == floor(q.e) ? ldexp(1.5, (int)q.e) : NAN; }

// What leaves the normal range of fp64 is unknown rather than infinite or zero.
static double exact_variance(params q, uint d) { return fabs(q.e) < 508 ? ldexp(1.0 / 12, 2 * (int)q.e) : NAN; }
#else
static inline real integrand(points *p, params q, coefficients c) { return c[0] * (R(1.0) + points_next(p)); }
#endif
