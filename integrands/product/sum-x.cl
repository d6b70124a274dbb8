// sum-x: sum_j x_j, additive: superposition dimension 1 at every d. It shows a bias of the coordinates d times, as
// d 2^-(bits+1) of sets whose coordinates are rounded down. The device's sum is therefore compensated.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return 0.5 * d; }
static double exact_variance(params q, uint d) { return d / 12.0; }
static double exact_variation(params q, uint d) { return d; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real high = R(0.0), low = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    // The error of high + x: Knuth, The Art of Computer Programming 2, section 4.2.2, theorem B.
    const real x = points_next(p);
    const real next = high + x, added = next - high;
    low += (high - (next - added)) + (x - added);
    high = next;
  }
  return high + low;
}
#endif
