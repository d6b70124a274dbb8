// kahan: compensated summation with feedback, |error| <= (2u + O(n u^2)) sum|y| (Higham 1993, eq. 3.11).
// Needs strict floating point: relaxed options let the compiler cancel the correction.
#pragma OPENCL FP_CONTRACT OFF
typedef scalar sum_scalar;
typedef real sum_value;
typedef struct {
  real total;
  real excess;  // what `total` holds too much
} sum;

static inline void sum_init(sum *s) {
  s->total = R(0.0);
  s->excess = R(0.0);
}
static inline sum_value sum_convert(real y) { return y; }
static inline void sum_add(sum *s, sum_value y) {
  const real corrected = y - s->excess;
  const real next = s->total + corrected;
  s->excess = (next - s->total) - corrected;
  s->total = next;
}
// The two words are added exactly on the host, so nothing of the correction is lost.
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  store_lanes(s->total, out);
  store_lanes(-s->excess, out + stride);
}
#pragma OPENCL FP_CONTRACT ON
