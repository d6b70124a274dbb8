// lattice: rank-1 lattices whose prefixes of 2^k points are lattices too (Hickernell et al. 2000):
// x_i = phi_2(gray(i)) z mod 1, an integer multiple of z in fixed point. 16 indices on, bit 4 + c of gray(i) flips
// (c the trailing zeros of the new index / 16) and so does bit 3; a bit that comes adds z 2^-(k+1), one that goes
// takes it away. Bit 3 is l_3 ^ i_4: it comes in one half of the lanes when it goes in the other, so the merged
// constants are one for lanes 0-7 and one for lanes 8-15.
// State: fp32 the top 23 bits of the fraction in the top of a signed word (offset by 2^31), fp64 the top 52
// bits in the low end of the word; what overflows is dropped by the conversion.
// Table (words; c columns, D dimensions):
//   [0] start_stride  [1] columns offset  [2] steps offset  [3] lanes offset  [4] starts offset
//   columns [c][D]; steps [c - 4][comes][half][D]; lanes [i_4][D][16]; starts [D] per replicate (the shift)
typedef struct {
  bits state[KOKSMA_DIM];
  __global const word *steps;
  uint j;     // index / 16, low half
  uint upper;  // 1 in lanes 8-15, for items of at most 8 lanes
  uint dim;
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  __global const word *columns = table + table[1];
  __global const word *lanes = table + table[3] + (first >> 4 & 1) * KOKSMA_DIM * KOKSMA_LANES + lane;
  __global const word *starts = table + table[4] + (ulong)replicate * table[0];
  p->steps = table + table[2];
  p->j = (uint)(first >> 4);
  p->upper = lane >> 3;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] = load_lanes(lanes + d * KOKSMA_LANES) + starts[d];
  const ulong gray = first ^ first >> 1;
  for (uint k = 4; gray >> k != 0; ++k) {
    if ((gray >> k & 1) == 0) continue;
    __global const word *column = columns + k * KOKSMA_DIM;
    KOKSMA_UNROLL
    for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] += column[d];
  }
}

static inline real points_next(points *p) {
#if KOKSMA_FP64
  return unit_from_mantissa((p->state[p->dim++] & (word)0x000FFFFFFFFFFFFFUL) | (word)KOKSMA_ONE_PATTERN);
#elif KOKSMA_CENTRED
  // The low 9 bits of the state are zero, so conversion, scaling and sum are all exact: (k + 1/2) 2^-23.
  return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(p->state[p->dim++])) * R(0x1.0p-32) + R(0x1.000002p-1);
#else
  return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(p->state[p->dim++])) * R(0x1.0p-32) + R(0.5);
#endif
}

static inline void points_step(points *p) {
  const uint c = trailing_zeros(++p->j);
  const uint comes = 1 - (p->j >> c >> 1 & 1);
  __global const word *step = p->steps + (c * 2 + comes) * 2 * KOKSMA_DIM;
#if KOKSMA_LANES_PER_ITEM == 16
  typedef KOKSMA_PASTE(KOKSMA_WORD, 8) half_bits;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d)
    p->state[d] += (bits)((half_bits)(step[d]), (half_bits)(step[KOKSMA_DIM + d]));
#else
  step += p->upper * KOKSMA_DIM;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_DIM; ++d) p->state[d] += step[d];
#endif
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
