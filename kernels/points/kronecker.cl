// kronecker: x_i = i alpha + shift mod 1, in natural order. alpha is a 64-bit fraction in both precisions, so that fp32
// draws the points of fp64 at 23 bits.
// The sum of a start (this block's first index) and a lane's offset l alpha: fp64 keeps it per lane in one word; fp32
// keeps the start alone, the same for all lanes, and adds the lane's high half and the carry out of the low halves.
// Table: [0] steps offset  [1] lanes offset  [2] starts offset  [3] unused; steps [D] (alpha), lanes [D][16] (l alpha),
// starts [D] per replicate (the shift). fp32 has each fraction as high and low half: [D][2], [D][high, low][16].
typedef struct {
#if KOKSMA_FP64
  bits state[KOKSMA_DIM];
  word step[KOKSMA_DIM];  // 16 alpha
#else
  word high[KOKSMA_DIM], low[KOKSMA_DIM];
  word step_high[KOKSMA_DIM], step_low[KOKSMA_DIM];
  __global const word *lanes;
#endif
  uint dim;
} points;

#if KOKSMA_FP64
static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  __global const word *alphas = table + table[0];
  __global const word *lanes = table + table[1] + lane;
  __global const word *starts = table + table[2] + (ulong)replicate * KOKSMA_DIM;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
    p->state[d] = load_lanes(lanes + d * KOKSMA_LANES) + (first * alphas[d] + starts[d]);
    p->step[d] = KOKSMA_LANES * alphas[d];
  }
}

static inline real points_next(points *p) { return unit_from_word(p->state[p->dim++]); }

static inline void points_step(points *p) {
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] += p->step[d];
  p->dim = 0;
}
#else
static inline ulong kronecker_fraction(__global const word *halves) { return (ulong)halves[0] << 32 | halves[1]; }

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  __global const word *alphas = table + table[0];
  __global const word *starts = table + table[2] + (ulong)replicate * KOKSMA_DIM * 2;
  p->lanes = table + table[1] + lane;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
    const ulong alpha = kronecker_fraction(alphas + 2 * d);
    const ulong start = first * alpha + kronecker_fraction(starts + 2 * d);
    p->high[d] = (word)(start >> 32);
    p->low[d] = (word)start;
    p->step_high[d] = (word)(KOKSMA_LANES * alpha >> 32);
    p->step_low[d] = (word)(KOKSMA_LANES * alpha);
  }
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
  __global const word *lanes = p->lanes + d * 2 * KOKSMA_LANES;
  const bits high = load_lanes(lanes) + p->high[d];
  // The low halves carry where the lane's exceeds what the start leaves free.
  const bits free = (bits)(p->low[d] ^ 0xFFFFFFFFu);
  return unit_from_word(select_bits(load_lanes(lanes + KOKSMA_LANES) > free, high + (word)1, high));
}

static inline void points_step(points *p) {
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
    p->low[d] += p->step_low[d];
    p->high[d] += p->step_high[d] + (p->low[d] < p->step_low[d]);
  }
  p->dim = 0;
}
#endif

static inline uint points_drawn(const points *p) { return p->dim; }
