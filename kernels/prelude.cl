// prelude.cl: the types and helpers every other piece is written against, for 1, 4, 8 or 16 lanes per
// work-item in fp32 or fp64. Contract: kernels/README.md. Raw literals, `?:`, any, all and ~ on reals and
// masks behave differently on scalars and vectors, so pieces use R(), select_real and the *_lanes helpers.
#if !defined(KOKSMA_LANES_PER_ITEM) || !defined(KOKSMA_FP64) || !defined(KOKSMA_DIM)
#error "KOKSMA_LANES_PER_ITEM, KOKSMA_FP64 and KOKSMA_DIM must be defined before prelude.cl"
#endif
#define KOKSMA_LANES 16  // samples l, l+16, l+32, ... of a block belong to lane l
#define KOKSMA_PASTE_(a, b) a##b
#define KOKSMA_PASTE(a, b) KOKSMA_PASTE_(a, b)

#if KOKSMA_FP64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define KOKSMA_FLOAT double
#define KOKSMA_WORD ulong
#define KOKSMA_SIGNED long
#define KOKSMA_MANTISSA_BITS 52
#define KOKSMA_ONE_PATTERN 0x3FF0000000000000UL  // the bits of 1.0
#define R(literal) ((real)(literal))
#else
#define KOKSMA_FLOAT float
#define KOKSMA_WORD uint
#define KOKSMA_SIGNED int
#define KOKSMA_MANTISSA_BITS 23
#define KOKSMA_ONE_PATTERN 0x3F800000U
// Pasting the suffix keeps fp64 out of fp32 kernels and rounds the literal once.
#define R(literal) ((real)(literal##f))
#endif

typedef KOKSMA_FLOAT scalar;  // one number of the cell's precision
typedef KOKSMA_WORD word;     // an unsigned integer of the same size
typedef __global const scalar *coefficients;  // [dimension][coefficient]

// Before a loop over the dimensions. Where there are few, the state can live in registers, which takes constant
// subscripts in every loop that touches it, and PoCL leaves such loops rolled by itself.
#if KOKSMA_UNROLLED
#define KOKSMA_UNROLL _Pragma("unroll")
#else
#define KOKSMA_UNROLL
#endif

#if KOKSMA_LANES_PER_ITEM == 1
typedef scalar real;
typedef word bits;
typedef int mask;
typedef uint words32;
#define KOKSMA_AS_REAL KOKSMA_PASTE(as_, KOKSMA_FLOAT)
#define KOKSMA_AS_BITS KOKSMA_PASTE(as_, KOKSMA_WORD)
#define KOKSMA_AS_SIGNED KOKSMA_PASTE(as_, KOKSMA_SIGNED)
#define KOKSMA_TO_REAL KOKSMA_PASTE(convert_, KOKSMA_FLOAT)
#define KOKSMA_TO_BITS KOKSMA_PASTE(convert_, KOKSMA_WORD)
#define load_lanes(pointer) (*(pointer))
#define store_lanes(value, pointer) (*(pointer) = (value))
static inline real select_real(mask m, real yes, real no) { return m ? yes : no; }
static inline int any_lane(mask m) { return m != 0; }
static inline int all_lanes(mask m) { return m != 0; }
static inline mask not_lanes(mask m) { return !m; }
static inline uint count_lanes(mask m) { return m != 0; }
#define KOKSMA_LANE_NUMBERS 0
#else
typedef KOKSMA_PASTE(KOKSMA_FLOAT, KOKSMA_LANES_PER_ITEM) real;
typedef KOKSMA_PASTE(KOKSMA_WORD, KOKSMA_LANES_PER_ITEM) bits;
typedef KOKSMA_PASTE(KOKSMA_SIGNED, KOKSMA_LANES_PER_ITEM) mask;
typedef KOKSMA_PASTE(uint, KOKSMA_LANES_PER_ITEM) words32;
#define KOKSMA_AS_REAL KOKSMA_PASTE(KOKSMA_PASTE(as_, KOKSMA_FLOAT), KOKSMA_LANES_PER_ITEM)
#define KOKSMA_AS_BITS KOKSMA_PASTE(KOKSMA_PASTE(as_, KOKSMA_WORD), KOKSMA_LANES_PER_ITEM)
#define KOKSMA_AS_SIGNED KOKSMA_PASTE(KOKSMA_PASTE(as_, KOKSMA_SIGNED), KOKSMA_LANES_PER_ITEM)
#define KOKSMA_TO_REAL KOKSMA_PASTE(KOKSMA_PASTE(convert_, KOKSMA_FLOAT), KOKSMA_LANES_PER_ITEM)
#define KOKSMA_TO_BITS KOKSMA_PASTE(KOKSMA_PASTE(convert_, KOKSMA_WORD), KOKSMA_LANES_PER_ITEM)
#define load_lanes(pointer) KOKSMA_PASTE(vload, KOKSMA_LANES_PER_ITEM)(0, pointer)
#define store_lanes(value, pointer) KOKSMA_PASTE(vstore, KOKSMA_LANES_PER_ITEM)(value, 0, pointer)
static inline real select_real(mask m, real yes, real no) { return select(no, yes, m); }
static inline int any_lane(mask m) { return any(m); }
static inline int all_lanes(mask m) { return all(m); }
static inline mask not_lanes(mask m) { return ~m; }
static inline uint count_lanes(mask m) {
  uint count = 0;
  KOKSMA_SIGNED lanes[KOKSMA_LANES_PER_ITEM];
  store_lanes(m, lanes);
  for (int l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) count += lanes[l] != 0;
  return count;
}
#if KOKSMA_LANES_PER_ITEM == 4
#define KOKSMA_LANE_NUMBERS (0, 1, 2, 3)
#elif KOKSMA_LANES_PER_ITEM == 8
#define KOKSMA_LANE_NUMBERS (0, 1, 2, 3, 4, 5, 6, 7)
#elif KOKSMA_LANES_PER_ITEM == 16
#define KOKSMA_LANE_NUMBERS (0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
#error "KOKSMA_LANES_PER_ITEM must be 1, 4, 8 or 16"
#endif
#endif

// 0, 1, 2, ... in the lanes of one work-item.
static inline words32 lane_numbers(void) { return (words32)KOKSMA_LANE_NUMBERS; }

// Number of trailing zeros, j > 0; ctz is missing in OpenCL C 1.2.
static inline uint trailing_zeros(uint j) { return 31 - clz(j & -j); }

// NaN or infinity, told from the bits: comparisons are unreliable under -cl-finite-math-only.
static inline mask nonfinite_lanes(real y) {
  const bits exponent = KOKSMA_AS_BITS(y) & (word)(KOKSMA_ONE_PATTERN << 1 | KOKSMA_ONE_PATTERN);
#if KOKSMA_LANES_PER_ITEM == 1
  return exponent == (word)(KOKSMA_ONE_PATTERN << 1 | KOKSMA_ONE_PATTERN);
#else
  return exponent == (bits)(word)(KOKSMA_ONE_PATTERN << 1 | KOKSMA_ONE_PATTERN);
#endif
}

// Mantissa state: s holds the bits of a float in [1,2), so one subtraction gives the coordinate, exactly.
// centred: (k + 1/2) 2^-m in (0,1); exact: k 2^-m in [0,1); m = KOKSMA_MANTISSA_BITS, k the mantissa of s.
// Checked over all mantissas: neither form rounds, and neither ever returns 1.
// KOKSMA_COARSE: in fp64 the coordinate that fp32 has, of the top 23 bits, so that the precisions can be compared
// at identical points.
static inline real unit_from_mantissa(bits s) {
#if KOKSMA_COARSE && KOKSMA_FP64
  s &= (word)0xFFFFFFFFE0000000UL;
#endif
#if KOKSMA_CENTRED
#if KOKSMA_COARSE && KOKSMA_FP64
  return KOKSMA_AS_REAL(s) - R(0x1.fffffep-1);
#elif KOKSMA_FP64
  return KOKSMA_AS_REAL(s) - R(0x1.fffffffffffffp-1);
#else
  return KOKSMA_AS_REAL(s) - R(0x1.fffffep-1);
#endif
#else
  return KOKSMA_AS_REAL(s) - R(1.0);
#endif
}

// The top mantissa bits of a full-width fraction word as a coordinate.
static inline real unit_from_word(bits w) {
  const uint shift = 8 * sizeof(word) - KOKSMA_MANTISSA_BITS;
  return unit_from_mantissa(w >> (word)shift | (word)KOKSMA_ONE_PATTERN);
}

#if KOKSMA_ROTATED
// The family that follows is wrapped by rotate.cl.
#define points unrotated_points
#define points_seek unrotated_seek
#define points_next unrotated_next
#define points_step unrotated_step
#define points_drawn unrotated_drawn
#endif

#if KOKSMA_COUNTERS
// Until the end of counters.cl: compilers keep functions that are called from two places apart, and the state of
// the points with them out of registers.
#define inline inline __attribute__((always_inline))
#define KOKSMA_OWN_CENTRED 0
#endif

// A family may offer centred coordinates of its own (kernels/README.md); where its slots are wrapped they are not met.
#ifndef KOKSMA_OWN_CENTRED
#define KOKSMA_OWN_CENTRED (!KOKSMA_ROTATED)
#endif
