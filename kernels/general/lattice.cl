// general/lattice: every rank-1 lattice by one kernel, for comparison with the planned ones (`koksma explain --measure`):
// the dimension, the baker's transform and the grid of coordinates are found at run time. All lanes share the part of a
// point that steps, in any dimension (the form that points/lattice.cl takes in many); its table comes behind the switches
// (kernels/README.md, "General kernels").
typedef struct {
  __global const word *columns;
  __global const word *lanes;  // of even j
  real origin, offset;
  uint stride;  // from one column to the next
  uint tent;
  uint j, dim, dims;
  word state[KOKSMA_GENERAL_STATES];
} points;

static inline void points_seek(points *p, __global const word *switches, ulong first, ulong n, ulong seed,
                               uint replicate, uint lane) {
  __global const word *table = switches + KOKSMA_GENERAL_TABLE;
  const ulong vector = (ulong)replicate * table[5];
  __global const word *starts = table + table[4] + (ulong)replicate * table[0];
  p->dims = (uint)switches[KOKSMA_GENERAL_DIM];
  // Where the table has no columns, the steps of bits that come are.
  const uint has_columns = table[1] != table[2];
  p->columns = table + vector + table[2] + p->dims;
  p->stride = 2 * p->dims;
  if (has_columns) {
    p->columns = table + vector + table[1];
    p->stride = p->dims;
  }
  p->lanes = table + table[3] + vector + lane;
  p->origin = general_origin(switches);
  p->offset = R(0.5);
  if (switches[KOKSMA_GENERAL_CENTRED] != 0) p->offset = R(0x1.000002p-1);
  p->tent = (uint)switches[KOKSMA_LATTICE_TENT_SWITCH];
  p->j = (uint)(first >> 4);
  p->dim = 0;
  for (uint d = 0; d < p->dims; ++d) p->state[d] = starts[d];
  const ulong gray = first ^ first >> 1;
  for (uint k = 4; gray >> k != 0; ++k) {
    if ((gray >> k & 1) == 0) continue;
    __global const word *column = p->columns + (k - 4) * p->stride;
    for (uint d = 0; d < p->dims; ++d) p->state[d] += column[d];
  }
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
  const bits x = load_lanes(p->lanes + ((p->j & 1) * p->dims + d) * KOKSMA_LANES) + p->state[d];
  if (p->tent != 0) {
    const bits folded = x ^ KOKSMA_AS_BITS(KOKSMA_AS_SIGNED(x) >> (KOKSMA_SIGNED)(8 * sizeof(word) - 1));
    const uint shift = 8 * sizeof(word) - KOKSMA_MANTISSA_BITS - 1;
    return KOKSMA_AS_REAL(folded >> (word)shift | (word)KOKSMA_ONE_PATTERN) - p->origin;
  }
#if KOKSMA_FP64
  return KOKSMA_AS_REAL((x & (word)0x000FFFFFFFFFFFFFUL) | (word)KOKSMA_ONE_PATTERN) - p->origin;
#else
  return KOKSMA_TO_REAL(KOKSMA_AS_SIGNED(x)) * R(0x1.0p-32) + p->offset;
#endif
}

static inline void points_step(points *p) {
  const uint c = trailing_zeros(++p->j);
  __global const word *column = p->columns + c * p->stride;
  const word sign = (word)0 - (word)(p->j >> c >> 1 & 1);  // all ones where the bit goes
  for (uint d = 0; d < p->dims; ++d) p->state[d] += (column[d] ^ sign) - sign;
  p->dim = 0;
}
