// kronecker: x_i = i alpha + shift mod 1, in natural order. alpha is a 64-bit fraction in both precisions, so that fp32
// draws the points of fp64 at 23 bits; with i = 16 j + l a point is a lane's part, l alpha, plus a part that all lanes
// share.
// fp64, and fp32 in few dimensions: the sum of both per lane, in 64-bit words.
// fp32 in many dimensions: the shared part alone, as halves; a coordinate adds the lane's high half and the carry out of
// the low halves, so that stepping stores no vectors.
// Table: [0] steps offset  [1] lanes offset  [2] starts offset  [3] unused; steps [D] (16 alpha), lanes [D][16]
// (l alpha), starts [D] per replicate (the shift). fp32 has each fraction as halves: steps and starts [D][high, low],
// lanes [D][high, low][16].
#define KOKSMA_KRONECKER_SHARED (!KOKSMA_FP64 && !KOKSMA_UNROLLED)

// W fractions. Wider than the words of fp32, but sums and shifts are all that is done to them.
#if KOKSMA_LANES_PER_ITEM == 1
typedef ulong fractions;
#else
typedef KOKSMA_PASTE(ulong, KOKSMA_LANES_PER_ITEM) fractions;
#endif

typedef struct {
#if KOKSMA_KRONECKER_SHARED
  word high[KOKSMA_DIM], next[KOKSMA_DIM];  // next = high + 1
  word free[KOKSMA_DIM];                    // how much the low halves of the lanes may hold without a carry
  __global const word *lanes;
#else
  fractions state[KOKSMA_DIM];
#endif
  __global const word *steps;
  uint dim;
} points;

#if !KOKSMA_FP64 && !KOKSMA_KRONECKER_SHARED
// The high half of every fraction. Picked out of the words by a shuffle: a shift and a conversion take five times the
// instructions.
#if KOKSMA_LANES_PER_ITEM == 1
static inline bits high_halves(fractions x) { return (uint)(x >> 32); }
#define KOKSMA_TO_FRACTIONS (ulong)
#else
#define KOKSMA_TO_FRACTIONS KOKSMA_PASTE(convert_ulong, KOKSMA_LANES_PER_ITEM)
#define KOKSMA_AS_HALVES KOKSMA_PASTE(as_uint, KOKSMA_LANES_PER_ITEM)
static inline bits high_halves(fractions x) { return (bits)(KOKSMA_AS_HALVES(x.lo).odd, KOKSMA_AS_HALVES(x.hi).odd); }
#endif
#endif

static inline ulong kronecker_fraction(__global const word *p, uint d) {
#if KOKSMA_FP64
  return p[d];
#else
  return (ulong)p[2 * d] << 32 | p[2 * d + 1];
#endif
}

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  const uint words = sizeof(ulong) / sizeof(word);
  __global const word *starts = table + table[2] + (ulong)replicate * KOKSMA_DIM * words;
  __global const word *lanes = table + table[1] + lane;
  p->steps = table + table[0];
  p->dim = 0;
#if KOKSMA_KRONECKER_SHARED
  p->lanes = lanes;
#endif
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
    const ulong start = (first >> 4) * kronecker_fraction(p->steps, d) + kronecker_fraction(starts, d);
#if KOKSMA_KRONECKER_SHARED
    p->high[d] = (word)(start >> 32);
    p->next[d] = p->high[d] + 1;
    p->free[d] = (word)start ^ 0xFFFFFFFFu;
#elif KOKSMA_FP64
    p->state[d] = load_lanes(lanes + d * KOKSMA_LANES) + start;
#else
    __global const word *halves = lanes + d * 2 * KOKSMA_LANES;
    p->state[d] = KOKSMA_TO_FRACTIONS(load_lanes(halves)) << 32 | KOKSMA_TO_FRACTIONS(load_lanes(halves + KOKSMA_LANES));
    p->state[d] += start;
#endif
  }
}

static inline bits kronecker_word(points *p) {
  const uint d = p->dim++;
#if KOKSMA_FP64
  return p->state[d];
#elif KOKSMA_KRONECKER_SHARED
  __global const word *halves = p->lanes + d * 2 * KOKSMA_LANES;
  const bits high = load_lanes(halves);
  // Both sums, as a masked addition costs less than adding a carry.
  return select_bits(load_lanes(halves + KOKSMA_LANES) > (bits)p->free[d], high + p->next[d], high + p->high[d]);
#else
  return high_halves(p->state[d]);
#endif
}

static inline real points_next(points *p) { return unit_from_word(kronecker_word(p)); }

static inline void points_step(points *p) {
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
#if KOKSMA_KRONECKER_SHARED
    const word step = p->steps[2 * d + 1];
    const word carry = p->free[d] < step;
    p->free[d] -= step;
    p->high[d] += p->steps[2 * d] + carry;
    p->next[d] = p->high[d] + 1;
#else
    p->state[d] += kronecker_fraction(p->steps, d);
#endif
  }
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
