// index-sums: a sum whose terms are sample indices, as bits: how many, sum i, sum i^2 and the XOR of a mix of i, all
// modulo 2^64. A term holds i + 1, so that 0, which the integration kernel puts for samples beyond N, is none.
// KOKSMA_INDEX_MIX: an odd multiplier; two rounds of xor-shift and multiply change half of all bits.
typedef ulong sum_scalar;
typedef bits sum_value;
typedef struct {
  bits count, total, squares, mixed;
} sum;

static inline bits index_mix(bits i) {
  for (uint round = 0; round < 2; ++round) i = (i ^ i >> 32ul) * KOKSMA_INDEX_MIX;
  return i ^ i >> 32ul;
}
static inline void sum_init(sum *s) {
  s->count = (bits)0;
  s->total = (bits)0;
  s->squares = (bits)0;
  s->mixed = (bits)0;
}
static inline sum_value sum_convert(real y) { return KOKSMA_AS_BITS(y); }
static inline void sum_add(sum *s, sum_value term) {
  const bits present = (term | ((bits)0 - term)) >> 63ul;  // 0 where term is 0, else 1
  const bits i = (term - 1ul) * present;
  s->count += present;
  s->total += i;
  s->squares += i * i;
  s->mixed ^= index_mix(i);
}
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  store_lanes(s->count, out);
  store_lanes(s->total, out + stride);
  store_lanes(s->squares, out + 2 * stride);
  store_lanes(s->mixed, out + 3 * stride);
}
