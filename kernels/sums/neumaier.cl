// neumaier: compensated summation without feedback (Neumaier 1974; Sum2 of Ogita, Rump & Oishi 2005).
// The correction is a naive sum itself: |error| <= n^2 u^2 sum|y|, which in fp32 is all of the sum from
// n = 2^24 on. Kept as the specimen of that; kahan and double-float feed the error back.
// Needs strict floating point: relaxed options let the compiler cancel the correction.
#pragma OPENCL FP_CONTRACT OFF
typedef scalar sum_scalar;
typedef real sum_value;
typedef struct {
  real total;
  real missing;  // what `total` lacks
} sum;

static inline void sum_init(sum *s) {
  s->total = R(0.0);
  s->missing = R(0.0);
}
static inline sum_value sum_convert(real y) { return y; }
static inline void sum_add(sum *s, sum_value y) {
  const real next = s->total + y;
  // The subtraction is exact for the larger of the two terms only.
  const real of_larger_total = (s->total - next) + y;
  const real of_larger_term = (y - next) + s->total;
  s->missing += select_real(fabs(s->total) >= fabs(y), of_larger_total, of_larger_term);
  s->total = next;
}
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  store_lanes(s->total, out);
  store_lanes(s->missing, out + stride);
}
#pragma OPENCL FP_CONTRACT ON
