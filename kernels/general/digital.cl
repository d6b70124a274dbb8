// general/digital: every base-2 net by one kernel, for comparison with the planned ones (`koksma explain --measure`): the
// dimension, nested scrambling, interlacing and the grid of coordinates are found at run time. States, steps and
// table are those of points/digital.cl, behind the switches (kernels/README.md, "General kernels").
typedef struct {
  __global const word *steps;
  __global const word *keys;
  real origin;      // that coordinates are counted from, on [1,2)
  uint components;  // interlaced to one coordinate
  uint nested;      // scrambled by hashing
  uint components_drawn, dims;
  uint j;
  bits state[KOKSMA_GENERAL_STATES];
} points;

static inline void points_seek(points *p, __global const word *switches, ulong first, ulong n, ulong seed,
                               uint replicate, uint lane) {
  __global const word *table = switches + KOKSMA_GENERAL_TABLE;
  const ulong matrix = (ulong)replicate * table[0];
  const ulong start = (ulong)replicate * table[1];
  __global const word *lanes = table + table[4] + matrix + lane;
  __global const word *starts = table + table[5] + start;
  p->steps = table + table[3] + matrix;
  p->keys = table + table[6] + start * 2;
  p->origin = general_origin(switches);
  p->components = (uint)switches[KOKSMA_DIGITAL_INTERLACE_SWITCH];
  p->nested = (uint)switches[KOKSMA_DIGITAL_OWEN_SWITCH];
  p->dims = (uint)switches[KOKSMA_GENERAL_DIM] * p->components;
  p->components_drawn = 0;
  p->j = (uint)(first >> 4);
  for (uint d = 0; d < p->dims; ++d) p->state[d] = load_lanes(lanes + d * KOKSMA_LANES) ^ starts[d];
  const ulong gray = first ^ first >> 1;
  for (uint k = 4; gray >> k != 0; ++k) {
    if ((gray >> k & 1) == 0) continue;
    __global const word *step = p->steps + (k - 4) * p->dims;
    for (uint d = 0; d < p->dims; ++d) p->state[d] ^= step[d];
  }
}

// Bit k goes to bit 2 k or 3 k, of as many bits as coordinates keep (points/digital.cl).
static inline bits general_spread(bits x, uint components) {
#if KOKSMA_FP64
  if (components == 2) {
    x &= (word)0x00000000FFFFFFFFUL;
    x = (x | x << 16) & (word)0x0000FFFF0000FFFFUL;
    x = (x | x << 8) & (word)0x00FF00FF00FF00FFUL;
    x = (x | x << 4) & (word)0x0F0F0F0F0F0F0F0FUL;
    x = (x | x << 2) & (word)0x3333333333333333UL;
    return (x | x << 1) & (word)0x5555555555555555UL;
  }
  x &= (word)0x00000000001FFFFFUL;
  x = (x | x << 32) & (word)0x001F00000000FFFFUL;
  x = (x | x << 16) & (word)0x001F0000FF0000FFUL;
  x = (x | x << 8) & (word)0x100F00F00F00F00FUL;
  x = (x | x << 4) & (word)0x10C30C30C30C30C3UL;
  return (x | x << 2) & (word)0x1249249249249249UL;
#else
  return x;  // interlaced sets are fp64's
#endif
}

static inline real points_next(points *p) {
  if (p->nested == 0) return KOKSMA_AS_REAL(p->state[p->components_drawn++]) - p->origin;
  bits x = (bits)(word)0;
  for (uint i = 0; i < p->components; ++i, ++p->components_drawn) {
    const uint d = p->components_drawn;
    const bits hashed = owen_hash(p->state[d], p->keys[2 * d], p->keys[2 * d + 1]);
    if (p->components == 1)
      x = hashed;
    else
      x |= general_spread(hashed, p->components) << (word)i;
  }
  return general_unit(reverse_bits(x), p->origin);
}

static inline void points_step(points *p) {
  __global const word *step = p->steps + trailing_zeros(++p->j) * p->dims;
  for (uint d = 0; d < p->dims; ++d) p->state[d] ^= step[d];
  p->components_drawn = 0;
}
