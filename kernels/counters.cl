// counters.cl: what integrate.cl counts of its samples where KOKSMA_COUNTERS is set. Comes after the family of points
// (and rotate.cl) and puts a watch around their slots; everything after it meets the watched ones.
// Everything is told from the bits: comparisons are unreliable under -cl-finite-math-only, and so are those of
// denormals where they are flushed to zero. An ordinary sample costs one range test and one branch; the others are
// counted exactly behind it.
#define KOKSMA_SIGN_BIT ((word)1 << (8 * sizeof(word) - 1))
#define KOKSMA_INFINITY_PATTERN ((word)(KOKSMA_ONE_PATTERN << 1 | KOKSMA_ONE_PATTERN) & (KOKSMA_SIGN_BIT - 1))
#define KOKSMA_LEAST_NORMAL ((word)1 << KOKSMA_MANTISSA_BITS)

#if KOKSMA_LANES_PER_ITEM == 1
typedef KOKSMA_SIGNED signed_bits;
static inline bits ones_of(mask m) { return (bits)m; }
#else
typedef mask signed_bits;
static inline bits ones_of(mask m) { return (word)0 - KOKSMA_AS_BITS(m); }
#endif

// The greatest of all lanes is folded to 8 lanes as it comes in fp64: the registers are the integrand's.
#if KOKSMA_LANES_PER_ITEM == 16 && KOKSMA_FP64
typedef KOKSMA_PASTE(KOKSMA_SIGNED, 8) greatest;
static inline greatest greatest_of(signed_bits b) { return max(b.lo, b.hi); }
#else
typedef signed_bits greatest;
static inline greatest greatest_of(signed_bits b) { return b; }
#endif

// A watch is what only has to be known of any lane. It tells of too many samples rather than too few, which are counted
// exactly afterwards. AVX-512 has a maximum of 64-bit integers, so fp64's 16 lanes are folded to 8. Elsewhere 32 bits of
// each lane have to do, in fp64 the high halves, half the registers: packed by shuffles inside 128 bits (vshufps), in an
// order of their own. The default study counted takes 1.10 times as long as not counted either way, with the other's
// watch 1.17 (AVX-512) and 1.21 (AVX2).
#if KOKSMA_FP64 && KOKSMA_LANES_PER_ITEM == 16
#ifdef __AVX512F__
#define KOKSMA_WATCH_IS_WIDE
#endif
#endif

#ifdef KOKSMA_WATCH_IS_WIDE

typedef greatest watch;
#define KOKSMA_LOWEST ((watch)(KOKSMA_SIGNED)KOKSMA_SIGN_BIT)
#define KOKSMA_BELOW_ONE ((watch)(KOKSMA_SIGNED)(KOKSMA_ONE_PATTERN - 2 + KOKSMA_SIGN_BIT))

static inline watch coordinate_watch(bits b) {
  return greatest_of(KOKSMA_AS_SIGNED(b + (KOKSMA_SIGN_BIT - 1)));
}

// Zeros, denormals and what is above the limit, lane by lane.
static inline mask odd_lanes(bits b, word limit) {
  const word least = KOKSMA_SIGN_BIT - KOKSMA_LEAST_NORMAL;
  const signed_bits above = KOKSMA_AS_SIGNED((b & (bits)(KOKSMA_SIGN_BIT - 1)) + least);
  return above > (signed_bits)(KOKSMA_SIGNED)(limit + least);
}

static inline watch odd_watch(bits b, word limit) {
  const mask odd = odd_lanes(b, limit);
  return odd.lo | odd.hi;
}

static inline watch odd_but_zero(watch odd, bits b, word limit, mask zero) {
  const mask left = odd_lanes(b, limit) & not_lanes(zero);
  return left.lo | left.hi;
}

#else

#if KOKSMA_LANES_PER_ITEM == 1
typedef int watch;
#define KOKSMA_AS_WATCH as_int
#else
typedef KOKSMA_PASTE(int, KOKSMA_LANES_PER_ITEM) watch;
#define KOKSMA_AS_WATCH KOKSMA_PASTE(as_int, KOKSMA_LANES_PER_ITEM)
#endif
#define KOKSMA_HIGH(w) ((uint)((w) >> (8 * sizeof(word) - 32)))
#define KOKSMA_SIGN_32 0x80000000u
#define KOKSMA_LOWEST ((watch)(int)KOKSMA_SIGN_32)
#define KOKSMA_BELOW_ONE ((watch)(int)(KOKSMA_HIGH(KOKSMA_ONE_PATTERN) - 2 + KOKSMA_SIGN_32))

static inline words32 high_halves(bits b) {
#if !KOKSMA_FP64
  return b;
#elif KOKSMA_LANES_PER_ITEM == 16
  const uint16 lo = as_uint16(b.lo), hi = as_uint16(b.hi);
  return (uint16)(lo.s13, hi.s13, lo.s57, hi.s57, lo.s9b, hi.s9b, lo.sdf, hi.sdf);
#elif KOKSMA_LANES_PER_ITEM == 8
  const uint8 lo = as_uint8(b.lo), hi = as_uint8(b.hi);
  return (uint8)(lo.s13, hi.s13, lo.s57, hi.s57);
#elif KOKSMA_LANES_PER_ITEM == 4
  return as_uint8(b).odd;
#else
  return (uint)(b >> 32);
#endif
}

static inline watch watch_of(mask m) {
#if KOKSMA_LANES_PER_ITEM == 1
  return m;
#else
  return KOKSMA_AS_WATCH(high_halves(KOKSMA_AS_BITS(m)));
#endif
}

static inline watch coordinate_watch(bits b) {
  return KOKSMA_AS_WATCH(high_halves(b) + (KOKSMA_SIGN_32 - 1));
}

// Zeros, denormals and what is above the limit; in fp64 also what has its high half.
static inline watch odd_watch(bits b, word limit) {
  const uint least = KOKSMA_SIGN_32 - KOKSMA_HIGH(KOKSMA_LEAST_NORMAL), end = KOKSMA_HIGH(limit) + !KOKSMA_FP64;
  const words32 above = (high_halves(b) & (KOKSMA_SIGN_32 - 1)) + least;
  return KOKSMA_AS_WATCH(above) >= (watch)(int)(end + least);
}

static inline watch odd_but_zero(watch odd, bits b, word limit, mask zero) {
  return odd ^ (odd & watch_of(zero));
}

#endif

// any_lane of what is 0 or -1, for every sample: PoCL's any() tests lane after lane.
static inline int some_watch(watch w) {
#if KOKSMA_LANES_PER_ITEM == 1
  return w != 0;
#else
#ifdef KOKSMA_WATCH_IS_WIDE
  const long4 quarter = w.lo | w.hi;
  const long2 pair = quarter.lo | quarter.hi;
#else
#if KOKSMA_LANES_PER_ITEM == 16
  const int8 half_of = w.lo | w.hi;
  const int4 quarter = half_of.lo | half_of.hi;
#elif KOKSMA_LANES_PER_ITEM == 8
  const int4 quarter = w.lo | w.hi;
#else
  const int4 quarter = w;
#endif
  const int2 pair = quarter.lo | quarter.hi;
#endif
  return (pair.x | pair.y) != 0;
#endif
}

// The sums of |f| and f^2 are in fp64 where the device has it.
#if KOKSMA_COUNTERS_FP64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double wide_scalar;
#define KOKSMA_WIDE double
#else
typedef scalar wide_scalar;
#define KOKSMA_WIDE KOKSMA_FLOAT
#endif
// Their 16 lanes are folded to 8 as they come: half the registers, and no more additions.
#if KOKSMA_LANES_PER_ITEM == 1
typedef wide_scalar wide, folded;
#define KOKSMA_TO_WIDE KOKSMA_PASTE(convert_, KOKSMA_WIDE)
#else
typedef KOKSMA_PASTE(KOKSMA_WIDE, KOKSMA_LANES_PER_ITEM) wide;
#define KOKSMA_TO_WIDE KOKSMA_PASTE(KOKSMA_PASTE(convert_, KOKSMA_WIDE), KOKSMA_LANES_PER_ITEM)
#if KOKSMA_LANES_PER_ITEM == 16
typedef KOKSMA_PASTE(KOKSMA_WIDE, 8) folded;
#else
typedef wide folded;
#endif
#endif

typedef struct {
  // The greatest of the bits of this sample's coordinates (or high halves), less 1 (0 wraps round to the top), the
  // sign bit flipped to compare as signed: those in (0,1) lie below all others, but for some below 2^-1042.
  watch highest;
  __global const word *table;
  ulong index, n, seed;  // index: of the vector's step, a multiple of 16
  uint replicate, lane;
  points inner;
} watched_points;

// Samples with a coordinate that is not in (0,1).
static inline watch outside_watch(const watched_points *p) { return p->highest > KOKSMA_BELOW_ONE; }

static inline void watched_seek(watched_points *p, __global const word *table, ulong first, ulong n, ulong seed,
                                uint replicate, uint lane) {
  points_seek(&p->inner, table, first, n, seed, replicate, lane);
  p->highest = KOKSMA_LOWEST;
  p->table = table;
  p->index = first;
  p->n = n;
  p->seed = seed;
  p->replicate = replicate;
  p->lane = lane;
}

static inline real watched_next(watched_points *p) {
  const real x = points_next(&p->inner);
  p->highest = max(p->highest, coordinate_watch(KOKSMA_AS_BITS(x)));
  return x;
}

static inline void watched_step(watched_points *p) {
  points_step(&p->inner);
  p->highest = KOKSMA_LOWEST;
  p->index += KOKSMA_LANES;
}

static inline uint watched_drawn(const watched_points *p) { return points_drawn(&p->inner); }

// Counts by lane, so that a sample adds nothing across them.
typedef struct {
  bits zero;  // samples f = +-0; all others are hits
  bits nan, plus_inf, minus_inf, denormal, blow_up;
  bits coordinate_le0, coordinate_ge1;
  greatest largest;  // the bits of the greatest |f| of finite samples
  folded sum_abs, sum_squares;  // of f times the scale, finite samples
} counters;

static inline void counters_init(counters *k) {
  const bits none = (bits)(word)0;
  k->zero = k->nan = k->plus_inf = k->minus_inf = k->denormal = k->blow_up = none;
  k->coordinate_le0 = k->coordinate_ge1 = none;
  k->largest = (greatest)(KOKSMA_SIGNED)0;
  k->sum_abs = k->sum_squares = (folded)(wide_scalar)0;
}

// The mask does not tell which coordinate it was: the sample's coordinates are drawn again.
static inline void count_coordinates(counters *k, const watched_points *p, mask valid) {
  points again;
  points_seek(&again, p->table, p->index, p->n, p->seed, p->replicate, p->lane);
  bits le0 = (bits)(word)0, ge1 = le0;
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
    const bits b = KOKSMA_AS_BITS(points_next(&again));
    const bits size = b & (bits)(KOKSMA_SIGN_BIT - 1);
    const mask is_nan = size > (bits)KOKSMA_INFINITY_PATTERN;
    const mask negative = b != size;
    le0 |= ones_of((size == (bits)(word)0) | (negative & not_lanes(is_nan)));
    ge1 |= ones_of(is_nan | ((size >= (bits)(word)KOKSMA_ONE_PATTERN) & not_lanes(negative)));
  }
  k->coordinate_le0 += le0 & ones_of(valid);
  k->coordinate_ge1 += ge1 & ones_of(valid);
}

// Samples of which one at least is not ordinary. Returns f with 0 for what is not finite.
static inline real count_exceptional(counters *k, real y, bits size, word limit) {
  const mask is_nan = size > (bits)KOKSMA_INFINITY_PATTERN;
  const mask is_inf = size == (bits)KOKSMA_INFINITY_PATTERN;
  const mask negative = KOKSMA_AS_BITS(y) != size;
  const mask denormal = (size < (bits)KOKSMA_LEAST_NORMAL) & (size != (bits)(word)0);
  k->nan += ones_of(is_nan);
  k->plus_inf += ones_of(is_inf & not_lanes(negative));
  k->minus_inf += ones_of(is_inf & negative);
  k->denormal += ones_of(denormal);
  k->blow_up += ones_of((size > (bits)limit) & not_lanes(is_nan));
  return KOKSMA_AS_REAL(KOKSMA_AS_BITS(y) & ((word)0 - ones_of(not_lanes(is_nan | is_inf))));
}

// Takes a vector of samples. limit: bits of the |f| above which a sample is a blow-up, of a normal number; scale: a
// power of two that brings f to about 1, so that squares neither overflow nor underflow.
static inline void count_samples(counters *k, real y, const watched_points *p, mask valid, word limit,
                                 wide_scalar scale) {
  const watch odd = odd_watch(KOKSMA_AS_BITS(y), limit);
  const watch outside = outside_watch(p);
  if (some_watch(odd | outside)) {
    const bits size = KOKSMA_AS_BITS(y) & (bits)(KOKSMA_SIGN_BIT - 1);
    const mask zero = size == (bits)(word)0;
    k->zero += ones_of(zero);
    if (some_watch(odd_but_zero(odd, KOKSMA_AS_BITS(y), limit, zero) | outside)) {
      y = count_exceptional(k, y, size, limit);
      if (some_watch(outside)) count_coordinates(k, p, valid);
    }
  }
  const real magnitude = KOKSMA_AS_REAL(KOKSMA_AS_BITS(y) & (bits)(KOKSMA_SIGN_BIT - 1));
  k->largest = max(k->largest, greatest_of(KOKSMA_AS_SIGNED(magnitude)));
  const wide scaled = KOKSMA_TO_WIDE(magnitude) * scale;
#if KOKSMA_LANES_PER_ITEM == 16
  k->sum_abs += scaled.lo + scaled.hi;
  k->sum_squares = fma(scaled.lo, scaled.lo, fma(scaled.hi, scaled.hi, k->sum_squares));
#else
  k->sum_abs += scaled;
  k->sum_squares = fma(scaled, scaled, k->sum_squares);
#endif
}

static inline ulong sum_lanes(bits count) {
  ulong sum = 0;
  word lanes[KOKSMA_LANES_PER_ITEM];
  store_lanes(count, lanes);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) sum += lanes[l];
  return sum;
}

static inline ulong greatest_lane(greatest w) {
  const uint count = sizeof(greatest) / sizeof(word);
  KOKSMA_SIGNED lanes[sizeof(greatest) / sizeof(word)], most = 0;
#if KOKSMA_LANES_PER_ITEM == 16 && KOKSMA_FP64
  vstore8(w, 0, lanes);
#else
  store_lanes(w, lanes);
#endif
  for (uint l = 0; l < count; ++l) most = max(most, lanes[l]);
  return (ulong)most;
}

static inline wide_scalar total_of(folded sums) {
  wide_scalar sum = 0;
  wide_scalar lanes[sizeof(folded) / sizeof(wide_scalar)];
#if KOKSMA_LANES_PER_ITEM == 16
  vstore8(sums, 0, lanes);
#else
  store_lanes(sums, lanes);
#endif
  for (uint l = 0; l < sizeof(folded) / sizeof(wide_scalar); ++l) sum += lanes[l];
  return sum;
}

// counts, sizes: this item's place in the first word of either, `stride` apart; integrator.cpp knows their order.
// samples: lanes that were taken, those beyond n too, which hold f = 0.
static inline void counters_store(const counters *k, ulong samples, __global ulong *counts,
                                  __global wide_scalar *sizes, ulong stride) {
  counts[0] = sum_lanes(k->nan);
  counts[stride] = sum_lanes(k->plus_inf);
  counts[2 * stride] = sum_lanes(k->minus_inf);
  counts[3 * stride] = sum_lanes(k->denormal);
  counts[4 * stride] = sum_lanes(k->coordinate_le0);
  counts[5 * stride] = sum_lanes(k->coordinate_ge1);
  counts[6 * stride] = samples - sum_lanes(k->zero);
  counts[7 * stride] = sum_lanes(k->blow_up);
  counts[8 * stride] = greatest_lane(k->largest);
  sizes[0] = total_of(k->sum_abs);
  sizes[stride] = total_of(k->sum_squares);
}

#undef inline
#define points watched_points
#define points_seek watched_seek
#define points_next watched_next
#define points_step watched_step
#define points_drawn watched_drawn
