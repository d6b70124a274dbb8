// lattice: rank-1 lattices whose prefixes of 2^k points are lattices too (Hickernell et al. 2000):
// x_i = phi_2(gray(i)) z mod 1, an integer multiple of z in fixed point. With i = 16 j + l, bits 0 to 3 of gray(i)
// depend on l and the lowest bit of j only, so x_i is a lane's part, one of two, plus a part that all lanes share.
// 16 indices on, bit 4 + c of gray(i) flips, c the trailing zeros of the new j; a bit that comes adds z 2^-(5+c) to the
// shared part, one that goes takes it away.
// Few dimensions keep the sum of both parts per lane, in registers, and step it with one load and one addition. More
// dimensions keep the shared part alone, a scalar: stepping then stores no vectors, and a coordinate adds the lane's
// part (measured on AVX-512, fp32: 1.4 times as fast at d = 64, no faster at d = 8).
// Words: fp32 the top 23 bits of the fraction in the top of a signed word (offset by 2^31), fp64 the top 52
// bits in the low end of the word; what overflows is dropped by the conversion.
// KOKSMA_LATTICE_TENT: words are whole fractions, and a coordinate is the baker's transform 1 - |2x - 1|
// (Hickernell 2002), taken on the bits: x = (k + 1/2) 2^-(m+1) goes to (l + 1/2) 2^-m, l = k or, above 1/2, the
// complement of k; so the coordinates keep all m bits, and none of it rounds.
// Table (words; c columns, D dimensions):
//   [0] start_stride  [1] columns offset  [2] steps offset  [3] lanes offset  [4] starts offset  [5] vector_stride
//   columns [c - 4][D] where KOKSMA_UNROLLED; steps [c - 4][comes][D], there with [16] lanes; lanes [j_0][D][16] per
//   vector; starts [D] per replicate (the shift). A vector_stride of 0 shares the one generating vector between replicates.
#if KOKSMA_UNROLLED
typedef bits lattice_part;
#define KOKSMA_LATTICE_STEP KOKSMA_LANES
#else
typedef word lattice_part;
#define KOKSMA_LATTICE_STEP 1
#endif

typedef struct {
  __global const word *steps;
#if !KOKSMA_UNROLLED
  __global const word *lanes;  // of even j
#endif
  uint j;  // index / 16, low half
  uint dim;
  lattice_part state[KOKSMA_DIM];
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  const ulong vector = (ulong)replicate * table[5];
  __global const word *lanes = table + table[3] + vector + lane;
  __global const word *starts = table + table[4] + (ulong)replicate * table[0];
  p->steps = table + table[2] + vector;
  p->j = (uint)(first >> 4);
  p->dim = 0;
#if KOKSMA_UNROLLED
  __global const word *columns = table + table[1] + vector;
  const uint stride = KOKSMA_DIM;
  p->steps += lane;
  lanes += (p->j & 1) * KOKSMA_DIM * KOKSMA_LANES;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] = load_lanes(lanes + d * KOKSMA_LANES) + starts[d];
#else
  __global const word *columns = p->steps + KOKSMA_DIM;  // the steps of bits that come
  const uint stride = 2 * KOKSMA_DIM;
  p->lanes = lanes;
  for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] = starts[d];
#endif
  const ulong gray = first ^ first >> 1;
  for (uint k = 4; gray >> k != 0; ++k) {
    if ((gray >> k & 1) == 0) continue;
    __global const word *column = columns + (k - 4) * stride;
    KOKSMA_UNROLL
    for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] += column[d];
  }
}

static inline bits lattice_word(points *p) {
  const uint d = p->dim++;
#if KOKSMA_UNROLLED
  return p->state[d];
#else
  return load_lanes(p->lanes + ((p->j & 1) * KOKSMA_DIM + d) * KOKSMA_LANES) + p->state[d];
#endif
}

static inline real points_next(points *p) {
#if KOKSMA_LATTICE_TENT
  const bits x = lattice_word(p);
  const bits folded = x ^ KOKSMA_AS_BITS(KOKSMA_AS_SIGNED(x) >> (KOKSMA_SIGNED)(8 * sizeof(word) - 1));  // its top bit is 0
  const uint shift = 8 * sizeof(word) - KOKSMA_MANTISSA_BITS - 1;
  return unit_from_mantissa(folded >> (word)shift | (word)KOKSMA_ONE_PATTERN);
#elif KOKSMA_FP64
  return unit_from_mantissa((lattice_word(p) & (word)0x000FFFFFFFFFFFFFUL) | (word)KOKSMA_ONE_PATTERN);
#elif KOKSMA_CENTRED
  // The low 9 bits of the state are zero, as no lattice of the family has more than 2^23 points, so conversion, scaling
  // and sum are all exact: (k + 1/2) 2^-23.
  return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(lattice_word(p))) * R(0x1.0p-32) + R(0x1.000002p-1);
#else
  return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(lattice_word(p))) * R(0x1.0p-32) + R(0.5);
#endif
}

#if KOKSMA_OWN_CENTRED && KOKSMA_UNROLLED && !KOKSMA_FP64 && !KOKSMA_LATTICE_TENT
// The word is (x - 1/2) 2^32, without the half unit of a centred grid.
#define KOKSMA_CENTRED_UNIT R(0x1.0p-32)
static inline real points_next_centred(points *p) {
  return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(lattice_word(p) | (word)KOKSMA_CENTRED << 8));
}
#endif

static inline void points_step(points *p) {
  const uint c = trailing_zeros(++p->j);
  const uint comes = 1 - (p->j >> c >> 1 & 1);
  __global const word *step = p->steps + (c * 2 + comes) * KOKSMA_DIM * KOKSMA_LATTICE_STEP;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) {
#if KOKSMA_UNROLLED
    p->state[d] += load_lanes(step + d * KOKSMA_LANES);
#else
    p->state[d] += step[d];
#endif
  }
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
