// naive: one running sum in the cell's precision. Kept as the specimen the others are compared with:
// |error| <= (n - 1) u sum|y| (Higham 1993).
typedef scalar sum_scalar;
typedef real sum_value;
typedef struct {
  real total;
} sum;

static inline void sum_init(sum *s) { s->total = R(0.0); }
static inline sum_value sum_convert(real y) { return y; }
static inline void sum_add(sum *s, sum_value y) { s->total += y; }
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  store_lanes(s->total, out);
}
