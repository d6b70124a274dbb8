// general/random: independent points by one kernel, for comparison with the planned ones (`koksma explain --measure`): the
// dimension and antithetic pairs are found at run time, the words are those of points/random.cl. There is no table behind the
// switches (kernels/README.md, "General kernels").
typedef struct {
  bits buffer[4];  // of the coordinates at hand
  ulong index;     // of the first lane of this item
  ulong seed;
  real origin;
  uint antithetic;
  uint replicate, dim, dims;
} points;

static inline void points_seek(points *p, __global const word *switches, ulong first, ulong n, ulong seed,
                               uint replicate, uint lane) {
  p->index = first + lane;
  p->seed = seed;
  p->origin = general_origin(switches);
  p->antithetic = (uint)switches[KOKSMA_RANDOM_ANTITHETIC_SWITCH];
  p->replicate = replicate;
  p->dims = (uint)switches[KOKSMA_GENERAL_DIM];
  p->dim = 0;
}

static inline real points_next(points *p) {
  const uint slot = p->dim & 3;
  if (slot == 0) {
    const uint antithetic = p->antithetic;
    words32 low = lane_numbers() + (uint)p->index;
    if (antithetic) low = ((lane_numbers() + (uint)(p->index & 1)) >> 1) + (uint)(p->index >> 1);
    random_quartet(low, (words32)(uint)(p->index >> (32 + antithetic)), p->seed, p->replicate, 0, p->dim / 4,
                   p->dims - p->dim, p->buffer);
    if (antithetic) {
      const bits odd = KOKSMA_TO_BITS((lane_numbers() + (uint)p->index) & 1u);
      for (uint i = 0; i < 4; ++i) p->buffer[i] ^= (word)0 - odd;
    }
  }
  ++p->dim;
  return general_unit(p->buffer[slot], p->origin);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}
