// halton-shuffles: products of 64-bit words, and tau(a), a hashed permutation of 1 ... b - 1, for the nested scrambling of
// digits in base b (halton.cl).
// floor(x y / 2^64), less at most 2: without the product of the low halves and two carries.
static inline words64 multiply_high(words64 x, ulong y) {
  const words64 high = x >> 32, low = x & 0xFFFFFFFFUL;
  const ulong upper = y >> 32, lower = y & 0xFFFFFFFFUL;
  return high * upper + (high * lower >> 32) + (low * upper >> 32);
}

// All ones in the lanes where a < b, a == b.
#if KOKSMA_LANES_PER_ITEM == 1
static inline words32 less_lanes(words32 a, words32 b) { return 0 - (words32)(a < b); }
static inline words32 equal_lanes(words32 a, words32 b) { return 0 - (words32)(a == b); }
#else
#define KOKSMA_AS_LANES KOKSMA_PASTE(as_uint, KOKSMA_LANES_PER_ITEM)
static inline words32 less_lanes(words32 a, words32 b) { return KOKSMA_AS_LANES(a < b); }
static inline words32 equal_lanes(words32 a, words32 b) { return KOKSMA_AS_LANES(a == b); }
#endif

// j_i for step i < 31: the top 27 bits of a hash times i + 1.
static inline words32 swap_of(words32 key0, words32 key1, uint i, __global const word *constants) {
  const words32 h = (key1 ^ (uint)constants[2 * i]) * (uint)constants[2 * i + 1] + key0;
  return (h >> 5) * (i + 1) >> 27;
}

// Where tau(a) of a shuffle of 1 ... b - 1 is: step i = 0 ... b - 2 of Fisher and Yates swaps places i and j_i <= i, so
// a - 1 goes to j_(a-1) and then wherever a later step takes it. Hash constants without structure: [i][2].
static inline words32 shuffled(words32 key0, words32 key1, uint a, uint base, __global const word *constants) {
  words32 place = swap_of(key0, key1, a - 1, constants);
  for (uint i = a; i + 1 < base; ++i) place ^= (place ^ i) & equal_lanes(place, swap_of(key0, key1, i, constants));
  return place + 1;
}

// Larger bases: a, by the replicate's shuffle of 1 ... b - 1, then three keyed bijections that do not commute: rotation mod
// b - 1, XOR where that stays below b - 1, a uniform factor mod b (Montgomery's product, whose 2^-16 is one more
// factor). The shuffle makes every order equally likely at a node, the factors make nodes independent.
static inline words32 multiplied(words32 key0, words32 key1, uint a, uint base, uint inverse) {
  const uint n = base - 1, digits = (1u << (32 - clz(n))) - 1;
  words32 x = a - 1 + ((key0 >> 16) * n >> 16);
  x = min(x, x - n);
  const words32 flip = key0 & digits;
  x ^= flip & less_lanes(x ^ flip, (words32)n);
  const words32 factor = 1 + (((key1 >> 16) * n + ((key1 & 0xFFFFu) * n >> 16)) >> 16);
  const words32 product = (x + 1) * factor;
  x = (product + (product * inverse & 0xFFFFu) * base) >> 16;
  return min(x, x - base);
}
