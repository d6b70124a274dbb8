// digital: every base-2 digital net or sequence. Sample i is C gray(i), gray(i) = i ^ (i >> 1): Gray-code
// order (Antonov & Saleev 1979), so 16 indices on every lane moves by the same XOR,
// column(4 + trailing zeros of j) ^ column(3), j the new index / 16 (gray(16 j + l) flips bit 3 at every step).
// The state is kept as the bits of a float in [1,2) ("mantissa state"), so a coordinate is one XOR and one
// subtraction. Linear scrambles and digital shifts only change the table.
// KOKSMA_DIGITAL_INTERLACE a > 1: a coordinate interlaces the digits of a scrambled components (Dick 2011): digit
// k of component i becomes digit a (k - 1) + i. The net has D = a d dimensions then, those of coordinate j from a j on.
// Table (words; c columns, s = c - 4 steps, D dimensions):
//   [0] matrix_stride  [1] start_stride  [2] unused  [3] steps offset  [4] lanes offset
//   [5] starts offset  [6] keys offset  [7] unused
//   steps [s][D], lanes [D][16] per matrix; starts [D] (digital shift and the pattern of 1.0)
//   and keys [D][2] (nested scrambling) per replicate. A stride of 0 shares the one matrix between replicates.
// KOKSMA_DIGITAL_SIGNED: "signed words" instead, for integrands that draw centred coordinates: the 23 bits of x stand
// on top of the word, the first of them flipped, so that the word as a signed integer is (x - 1/2) 2^32 and one
// conversion makes the centred coordinate; on centred grids bit 8 is the half unit. At most 24 bits: it never rounds.
#define KOKSMA_DIGITAL_DIM (KOKSMA_DIM * KOKSMA_DIGITAL_INTERLACE)
// What build_digital (harness/points/digital.cpp) decides by too.
#define KOKSMA_DIGITAL_SIGNED \
  (KOKSMA_CENTRED_DRAWS && !KOKSMA_FP64 && KOKSMA_UNROLLED && !KOKSMA_DIGITAL_OWEN && KOKSMA_DIGITAL_INTERLACE == 1)
// Many states are stepped as they are drawn: what does not fit the registers then passes the caches once per sample,
// not twice. Measured with shifted Sobol' points on AVX2 and AVX-512: 1.3 times as fast at d = 128 and 1024, by up to a
// tenth in fp32 at d = 6 to 16; in fp64 up to d = 16, and beside Owen's hash, no difference; slower at d = 2.
#define KOKSMA_DIGITAL_STEPS_LATE (KOKSMA_DIGITAL_DIM > 4)

typedef struct {
  __global const word *steps;
#if KOKSMA_DIGITAL_STEPS_LATE
  __global const word *step;  // to be taken by the coordinates not yet drawn
#endif
#if KOKSMA_DIGITAL_OWEN
  __global const word *keys;
#endif
  uint j;    // index / 16, low half
  uint dim;  // coordinates drawn
  // Last: clang then sees that no store to it changes the others, and keeps them in registers.
  bits state[KOKSMA_DIGITAL_DIM];
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  const ulong matrix = (ulong)replicate * table[0];
  const ulong start = (ulong)replicate * table[1];
  __global const word *lanes = table + table[4] + matrix + lane;
  __global const word *starts = table + table[5] + start;
  p->steps = table + table[3] + matrix;
#if KOKSMA_DIGITAL_OWEN
  p->keys = table + table[6] + start * 2;
#endif
  p->j = (uint)(first >> 4);
  p->dim = 0;
#if KOKSMA_DIGITAL_SIGNED
  const word centre = 0x80000000U | (word)KOKSMA_CENTRED << 8;
#else
  const word centre = 0;
#endif
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIGITAL_DIM; ++d)
    p->state[d] = load_lanes(lanes + d * KOKSMA_LANES) ^ (starts[d] ^ centre);
  // first is a multiple of 16: the bits of gray(first) below the third belong to the lanes, and from the third on an
  // even number is set, so that of columns k and 3 together the latter cancels.
  const ulong gray = first ^ first >> 1;
  for (uint k = 4; gray >> k != 0; ++k) {
    if ((gray >> k & 1) == 0) continue;
    __global const word *step = p->steps + (k - 4) * KOKSMA_DIGITAL_DIM;
    KOKSMA_UNROLL
    for (uint d = 0; d < KOKSMA_DIGITAL_DIM; ++d) p->state[d] ^= step[d];
  }
#if KOKSMA_DIGITAL_STEPS_LATE
  // The first draws step too: any words do, set in here and cancelled there. Not unrolled, which leaves the states on
  // the stack: unrolled, as for states in registers, kernels at d = 8 are 7 to 15 % slower (AVX2 and AVX-512).
  p->step = lanes;
  for (uint d = 0; d < KOKSMA_DIGITAL_DIM; ++d) p->state[d] ^= p->step[d];
#endif
}

static inline bits drawn_state(points *p, uint d) {
#if KOKSMA_DIGITAL_STEPS_LATE
  return p->state[d] ^= p->step[d];
#else
  return p->state[d];
#endif
}

#if KOKSMA_DIGITAL_OWEN
static inline bits scrambled_component(points *p, uint d) {
  return owen_hash(drawn_state(p, d), p->keys[2 * d], p->keys[2 * d + 1]);
}
#endif

#if KOKSMA_DIGITAL_INTERLACE > 1
// Bit k of the low bits of x goes to bit a k. Reversed words: bit k is digit k + 1.
static inline bits spread_bits(bits x) {
#if KOKSMA_DIGITAL_INTERLACE == 2
  x &= (word)0x00000000FFFFFFFFUL;
  x = (x | x << 16) & (word)0x0000FFFF0000FFFFUL;
  x = (x | x << 8) & (word)0x00FF00FF00FF00FFUL;
  x = (x | x << 4) & (word)0x0F0F0F0F0F0F0F0FUL;
  x = (x | x << 2) & (word)0x3333333333333333UL;
  return (x | x << 1) & (word)0x5555555555555555UL;
#else
  x &= (word)0x00000000001FFFFFUL;
  x = (x | x << 32) & (word)0x001F00000000FFFFUL;
  x = (x | x << 16) & (word)0x001F0000FF0000FFUL;
  x = (x | x << 8) & (word)0x100F00F00F00F00FUL;
  x = (x | x << 4) & (word)0x10C30C30C30C30C3UL;
  return (x | x << 2) & (word)0x1249249249249249UL;
#endif
}

static inline real points_next(points *p) {
  const uint first = p->dim++ * KOKSMA_DIGITAL_INTERLACE;
  bits x = (bits)(word)0;
  _Pragma("unroll")
  for (uint i = 0; i < KOKSMA_DIGITAL_INTERLACE; ++i)
    x |= spread_bits(scrambled_component(p, first + i)) << (word)i;
  return unit_from_word(reverse_bits(x));
}
#elif KOKSMA_DIGITAL_OWEN
static inline real points_next(points *p) { return unit_from_word(reverse_bits(scrambled_component(p, p->dim++))); }
#elif KOKSMA_DIGITAL_SIGNED
static inline real signed_word(points *p) { return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(drawn_state(p, p->dim++))); }
static inline real points_next(points *p) { return signed_word(p) * R(0x1.0p-32) + R(0.5); }
#if KOKSMA_OWN_CENTRED
#define KOKSMA_CENTRED_UNIT R(0x1.0p-32)
static inline real points_next_centred(points *p) { return signed_word(p); }
#endif
#else
static inline real points_next(points *p) { return unit_from_mantissa(drawn_state(p, p->dim++)); }
#endif

static inline void points_step(points *p) {
  __global const word *step = p->steps + trailing_zeros(++p->j) * KOKSMA_DIGITAL_DIM;
#if KOKSMA_DIGITAL_STEPS_LATE
  p->step = step;
#else
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIGITAL_DIM; ++d) p->state[d] ^= step[d];
#endif
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
