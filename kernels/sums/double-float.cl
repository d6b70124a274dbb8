// double-float: the sum is an unevaluated pair high + low, |low| <= u |high|, renormalised at every term
// (DWPlusFP, Joldes, Muller & Popescu 2017, algorithm 4): |error| <= 2 n u^2 sum|y|. In fp64 this is double-double.
// Needs strict floating point: relaxed options let the compiler cancel the errors.
#pragma OPENCL FP_CONTRACT OFF
typedef scalar sum_scalar;
typedef real sum_value;
typedef struct {
  real high;
  real low;
} sum;

static inline void sum_init(sum *s) {
  s->high = R(0.0);
  s->low = R(0.0);
}
static inline sum_value sum_convert(real y) { return y; }
static inline void sum_add(sum *s, sum_value y) {
  // TwoSum (Knuth): next + error = high + y, whichever is larger.
  const real next = s->high + y;
  const real of_y = next - s->high;
  const real error = (s->high - (next - of_y)) + (y - of_y);
  // FastTwoSum (Dekker) with all of the small parts.
  const real small = s->low + error;
  s->high = next + small;
  s->low = small - (s->high - next);
}
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  store_lanes(s->high, out);
  store_lanes(s->low, out + stride);
}
#pragma OPENCL FP_CONTRACT ON
