// double: samples of either precision are added in fp64, |error| <= (n - 1) 2^-53 sum|y|.
// One conversion per sample: nearly free beside the d coordinates of that sample.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double sum_scalar;
#if KOKSMA_LANES_PER_ITEM == 1
typedef double sum_value;
static inline sum_value sum_convert(real y) { return convert_double(y); }
#else
typedef KOKSMA_PASTE(double, KOKSMA_LANES_PER_ITEM) sum_value;
static inline sum_value sum_convert(real y) {
  return KOKSMA_PASTE(convert_double, KOKSMA_LANES_PER_ITEM)(y);
}
#endif
typedef struct {
  sum_value total;
} sum;

static inline void sum_init(sum *s) { s->total = (sum_value)(0); }
static inline void sum_add(sum *s, sum_value y) { s->total += y; }
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  store_lanes(s->total, out);
}
