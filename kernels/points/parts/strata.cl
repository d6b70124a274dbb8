// strata: (cell + u) / n as a coordinate, n <= 2^30; comes after philox.cl (multiply_wide). All of it is integer
// arithmetic, so the result is the same on every device: the fraction (cell 2^w + u) / n, u a word of w bits, is divided
// exactly, 32 bits at a time, and its top bits are the coordinate. The top half of the fp64 quotient is the fp32
// quotient: both precisions draw one point at two resolutions.
// A centred coordinate is in [cell/n, (cell+1)/n) as a real number. For n = 2^k that is plain: the top k bits are the
// cell. For other n the grid's centre next to the point may lie across the border, then it moves one step back
// (n <= 2^23 in fp32; beyond, the grid does not resolve the strata).
typedef struct {
  uint n;
  uint high, low;  // floor((2^64 - 1) / n)
  uint log2_n;     // of a power of two
  uint is_power;
} strata;

static inline strata strata_of(uint n) {
  strata s;
  const ulong reciprocal = 0xFFFFFFFFFFFFFFFFUL / n;
  s.n = n;
  s.high = (uint)(reciprocal >> 32);
  s.low = (uint)reciprocal;
  s.log2_n = 31 - clz(n);
  s.is_power = (n & (n - 1)) == 0;
  return s;
}

// floor((high 2^32 + low) / n) and the remainder, high < n. The three products, each rounded down, fall short of the
// quotient by less than 3 + n 2^-32; so the remainder is below 3.25 n < 2^32, and three subtractions end it.
static inline words32 divide_words(words32 high, words32 low, strata s, words32 *remainder) {
  words32 a, b, unused;
  multiply_wide(high, s.low, &a, &unused);
  multiply_wide(low, s.high, &b, &unused);
  words32 quotient = high * s.high + a + b;
  words32 rest = low - quotient * s.n;
  for (uint i = 0; i < 3; ++i) {
    const words32 less = min(rest, rest - s.n);  // the difference wraps where rest < n
    quotient += (less - rest) >> 31;             // -n is negative, n <= 2^31
    rest = less;
  }
  *remainder = rest;
  return quotient;
}

#if KOKSMA_LANES_PER_ITEM == 1
#define KOKSMA_TO_WORDS32 convert_uint
#define KOKSMA_AS_INT as_int
#else
#define KOKSMA_TO_WORDS32 KOKSMA_PASTE(convert_uint, KOKSMA_LANES_PER_ITEM)
#define KOKSMA_AS_INT KOKSMA_PASTE(as_int, KOKSMA_LANES_PER_ITEM)
#endif

// The whole fraction word of (cell + u) / n.
static inline bits stratum_word(words32 cell, bits u, strata s) {
  if (s.is_power) return KOKSMA_TO_BITS(cell) << (word)(8 * sizeof(word) - s.log2_n) | u >> (word)s.log2_n;
  words32 rest;
#if KOKSMA_FP64
  const words32 upper = divide_words(cell, KOKSMA_TO_WORDS32(u >> 32), s, &rest);
  const words32 lower = divide_words(rest, KOKSMA_TO_WORDS32(u & 0xFFFFFFFFUL), s, &rest);
  return KOKSMA_TO_BITS(upper) << 32 | KOKSMA_TO_BITS(lower);
#else
  return divide_words(cell, u, s, &rest);
#endif
}

// A coordinate in stratum `cell` of n; u is uniform over the full word.
static inline real in_stratum(words32 cell, bits u, strata s) {
  real x = unit_from_word(stratum_word(cell, u, s));
#if KOKSMA_CENTRED
  // c, n and x are exact, and a fused product rounds once: its sign is that of x n - c. The point itself is inside and
  // at most half a step away from x, so one step is enough.
  const real c = KOKSMA_TO_REAL(KOKSMA_AS_INT(cell));
  const real n = (real)(scalar)s.n;
#if KOKSMA_FP64
  const real step = R(0x1.0p-52);
#else
  const real step = R(0x1.0p-23);
#endif
  if (!s.is_power && (KOKSMA_FP64 || s.n <= 1u << 23)) {
    x += select_real(fma(x, n, -c) < R(0.0), step, R(0.0));
    x -= select_real(fma(x, n, -(c + R(1.0))) >= R(0.0), step, R(0.0));
  }
#endif
  return x;
}
