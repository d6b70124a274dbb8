// fixed: multiples of 2^-62 in integers, so that the sum is the same in any order. Each term is rounded once, to the
// nearest multiple: |error| <= 2^-63 a term, none at all for fp32 samples from 2^-39 and fp64 samples from 2^-10 on.
// The 126-bit number is kept as three signed 64-bit ones in units of 1, 2^-31 and 2^-62, which need no carries:
// 2^32 terms, all that a block can have, are below 2^63 in each.
// A sample of 2^31 or above, infinite or NaN makes its lane's sum NaN; it is found from its bits, whatever the options.
typedef scalar sum_scalar;
typedef real sum_value;
#if KOKSMA_LANES_PER_ITEM == 1
typedef long sum_digits;
#else
typedef KOKSMA_PASTE(long, KOKSMA_LANES_PER_ITEM) sum_digits;
#endif
typedef struct {
  sum_digits digit[3];  // of 1, 2^-31, 2^-62
  bits beyond;          // not 0: a sample was out of range
} sum;

#if KOKSMA_LANES_PER_ITEM == 1
static inline sum_digits sum_to_digits(real y) { return convert_long(y); }
static inline bits sum_out_of_range(bits magnitude, word limit) { return magnitude >= limit; }
#else
static inline sum_digits sum_to_digits(real y) {
  return KOKSMA_PASTE(convert_long, KOKSMA_LANES_PER_ITEM)(y);
}
static inline bits sum_out_of_range(bits magnitude, word limit) {
  return KOKSMA_AS_BITS(magnitude >= (bits)limit);
}
#endif

static inline void sum_init(sum *s) {
  for (uint k = 0; k < 3; ++k) s->digit[k] = (sum_digits)0;
  s->beyond = (bits)0;
}
static inline sum_value sum_convert(real y) { return y; }
static inline void sum_add(sum *s, sum_value y) {
  // The bits of 2^31: those of 1 with 31 more in the exponent.
  const word limit = (word)KOKSMA_ONE_PATTERN + ((word)31 << KOKSMA_MANTISSA_BITS);
  const bits magnitude = KOKSMA_AS_BITS(y) << 1 >> 1;
  const bits out = sum_out_of_range(magnitude, limit);
  s->beyond |= out;
  y = select_real(KOKSMA_AS_SIGNED(out), (real)R(0.0), y);
  // Every difference and product is exact; only the last digit is rounded.
  const real one = trunc(y);
  const real below = (y - one) * R(2147483648.0);
  const real middle = trunc(below);
  s->digit[0] += sum_to_digits(one);
  s->digit[1] += sum_to_digits(middle);
  s->digit[2] += sum_to_digits(rint((below - middle) * R(2147483648.0)));
}

// The bits of a digit from `first` on that `kept` has, in units of 2^-place.
static inline real sum_part(sum_digits digit, uint first, long kept, int place) {
  return ldexp(KOKSMA_TO_REAL(digit >> (long)first & kept), (int)first - place);
}
// Each digit in parts that a word of the precision holds exactly: two of 32 bits, or three of 21; the first has the
// sign.
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
#if KOKSMA_FP64
  const uint width = 32;
#else
  const uint width = 21;
#endif
  const uint parts = KOKSMA_SUM_WORDS / 3;
  for (uint k = 0; k < 3; ++k) {
    long kept = -1;
    for (uint part = 0; part < parts; ++part) {
      real w = sum_part(s->digit[k], (parts - 1 - part) * width, kept, 31 * (int)k);
      // All ones are a NaN.
      if (k + part == 0) w = select_real(KOKSMA_AS_SIGNED(s->beyond), KOKSMA_AS_REAL((bits)0 - 1), w);
      store_lanes(w, out + (k * parts + part) * stride);
      kept = ((long)1 << width) - 1;
    }
  }
}
