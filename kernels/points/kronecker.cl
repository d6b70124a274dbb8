// kronecker: x_i = i alpha + shift mod 1, in natural order. alpha is a 64-bit fraction in both precisions, so that fp32
// draws the points of fp64 at 23 bits; with i = 16 j + l a point is a lane's part, l alpha, plus a part that all lanes
// share. Few dimensions keep the sum of both per lane, many the shared part alone: stepping then stores no vectors, and a
// coordinate adds the lane's part.
// Table, all of it 64-bit (fp32: low half first): [0] steps offset  [1] lanes offset  [2] starts offset  [3] unused;
// steps [D] (16 alpha), lanes [D][16] (l alpha), starts [D] per replicate (the shift). Offsets count 64-bit words.
#define KOKSMA_KRONECKER_SHARED (!KOKSMA_UNROLLED)

// W fractions. Wider than the words of fp32, but sums and shuffles are all that is done to them.
#if KOKSMA_LANES_PER_ITEM == 1
typedef ulong fractions;
#else
typedef KOKSMA_PASTE(ulong, KOKSMA_LANES_PER_ITEM) fractions;
#endif

#if KOKSMA_KRONECKER_SHARED
typedef ulong kronecker_part;
#else
typedef fractions kronecker_part;
#endif

typedef struct {
  __global const ulong *steps;
  __global const ulong *lanes;
  uint dim;
  kronecker_part state[KOKSMA_DIM];
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  __global const ulong *words = (__global const ulong *)table;
  __global const ulong *starts = words + words[2] + (ulong)replicate * KOKSMA_DIM;
  p->steps = words + words[0];
  p->lanes = words + words[1] + lane;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
    p->state[d] = (first >> 4) * p->steps[d] + starts[d];
#if !KOKSMA_KRONECKER_SHARED
    p->state[d] += load_lanes(p->lanes + d * KOKSMA_LANES);
#endif
  }
}

static inline fractions kronecker_fractions(points *p) {
  const uint d = p->dim++;
#if KOKSMA_KRONECKER_SHARED
  return load_lanes(p->lanes + d * KOKSMA_LANES) + p->state[d];
#else
  return p->state[d];
#endif
}

static inline real points_next(points *p) {
  const fractions x = kronecker_fractions(p);
#if KOKSMA_FP64
  return unit_from_word(x);
#elif KOKSMA_LANES_PER_ITEM == 1
  return unit_from_word((word)(x >> 32));
#else
  // The high half of every fraction, by a shuffle: a shift and a conversion take five times the instructions.
#define KOKSMA_AS_HALVES KOKSMA_PASTE(as_uint, KOKSMA_LANES_PER_ITEM)
  return unit_from_word((bits)(KOKSMA_AS_HALVES(x.lo).odd, KOKSMA_AS_HALVES(x.hi).odd));
#endif
}

static inline void points_step(points *p) {
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] += p->steps[d];
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
