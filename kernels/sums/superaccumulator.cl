// superaccumulator: a fixed-point number that has a place for every bit of every finite sample, so sums are exact and
// the same in any order (Kulisch 2013; digits with deferred carries as in Neal 2015, section 3).
// Digit k weighs 2^(first + k step), as the entry says; samples are taken apart by their bits, so no build option
// changes a result. Lanes are scalar code: a digit's place differs from lane to lane, which vectors can not index.
// NaN and infinities are remembered and stored as themselves, infinities of both signs as NaN.
typedef scalar sum_scalar;
typedef real sum_value;
#if KOKSMA_FP64
#define KOKSMA_DIGIT_BITS 48
#else
#define KOKSMA_DIGIT_BITS 24
#endif
#define KOKSMA_DIGIT_MASK (((ulong)1 << KOKSMA_DIGIT_BITS) - 1)
// A term changes a digit by less than 2^53: carries can wait for 2^9 terms.
#define KOKSMA_DEFERRED_CARRIES 512
enum { sum_has_nan = 1, sum_has_plus_infinity = 2, sum_has_minus_infinity = 4 };
typedef struct {
  long digit[KOKSMA_LANES_PER_ITEM][KOKSMA_SUM_WORDS];
  uint faults[KOKSMA_LANES_PER_ITEM];
  uint deferred;
} sum;

static inline void sum_init(sum *s) {
  s->deferred = 0;
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) {
    s->faults[l] = 0;
    for (uint k = 0; k < KOKSMA_SUM_WORDS; ++k) s->digit[l][k] = 0;
  }
}
static inline sum_value sum_convert(real y) { return y; }

// Brings every digit but the signed top one into [0, 2^KOKSMA_DIGIT_BITS).
static inline void sum_carry(long *digit) {
  for (uint k = 0; k + 1 < KOKSMA_SUM_WORDS; ++k) {
    digit[k + 1] += digit[k] >> KOKSMA_DIGIT_BITS;
    digit[k] &= KOKSMA_DIGIT_MASK;
  }
}

static inline void sum_add_bits(long *digit, uint *faults, ulong pattern) {
  // The exponent field of NaN and infinities: that of 1 is half of it, rounded down.
  const uint most = 2 * (uint)(KOKSMA_ONE_PATTERN >> KOKSMA_MANTISSA_BITS) + 1;
  const uint exponent = (uint)(pattern >> KOKSMA_MANTISSA_BITS) & most;
  const long sign = (long)(pattern >> (8 * sizeof(word) - 1));
  ulong mantissa = pattern & (((ulong)1 << KOKSMA_MANTISSA_BITS) - 1);
  if (exponent == most) {
    if (mantissa != 0) *faults |= sum_has_nan;
    else if (sign != 0) *faults |= sum_has_minus_infinity;
    else *faults |= sum_has_plus_infinity;
    return;
  }
  // Denormals share the place of the smallest normal exponent and lack the hidden bit.
  const uint normal = exponent != 0;
  mantissa |= (ulong)normal << KOKSMA_MANTISSA_BITS;
  const uint place = exponent - normal;
  const uint k = place / KOKSMA_DIGIT_BITS, shift = place % KOKSMA_DIGIT_BITS;
  const long low = (long)(mantissa << shift & KOKSMA_DIGIT_MASK);
  const long high = (long)(mantissa >> (KOKSMA_DIGIT_BITS - shift));
  digit[k] += (low ^ -sign) + sign;
  digit[k + 1] += (high ^ -sign) + sign;
}

static inline void sum_add(sum *s, sum_value y) {
  word pattern[KOKSMA_LANES_PER_ITEM];
  store_lanes(KOKSMA_AS_BITS(y), pattern);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) sum_add_bits(s->digit[l], &s->faults[l], pattern[l]);
  if (++s->deferred == KOKSMA_DEFERRED_CARRIES) {
    for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) sum_carry(s->digit[l]);
    s->deferred = 0;
  }
}

// Sign and magnitude, so that the digits of one sample add up to it without rounding.
static inline void sum_store(const sum *s, __global sum_scalar *out, ulong stride) {
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) {
    long digit[KOKSMA_SUM_WORDS];
    for (uint k = 0; k < KOKSMA_SUM_WORDS; ++k) digit[k] = s->digit[l][k];
    sum_carry(digit);
    const long sign = -(long)(digit[KOKSMA_SUM_WORDS - 1] < 0);
    for (uint k = 0; k < KOKSMA_SUM_WORDS; ++k) digit[k] = (digit[k] ^ sign) - sign;
    sum_carry(digit);
    for (uint k = 0; k < KOKSMA_SUM_WORDS; ++k) out[l + k * stride] = (scalar)((digit[k] ^ sign) - sign);

    const word infinity = (word)(KOKSMA_ONE_PATTERN << 1 | KOKSMA_ONE_PATTERN);
    const word negative = (word)1 << (8 * sizeof(word) - 1);
    word fault = infinity | infinity >> 1;  // a NaN
    if (s->faults[l] == sum_has_plus_infinity) fault = infinity;
    if (s->faults[l] == sum_has_minus_infinity) fault = infinity | negative;
    if (s->faults[l] != 0) out[l] = KOKSMA_PASTE(as_, KOKSMA_FLOAT)(fault);
  }
}
