// general/kronecker: Kronecker sequences by one kernel, for comparison with the planned ones (`koksma explain --measure`):
// the dimension and the grid of coordinates are found at run time; all lanes share the part of a point that steps, in any
// dimension. The table of points/kronecker.cl comes behind the switches (kernels/README.md, "General kernels").
#if KOKSMA_LANES_PER_ITEM == 1
typedef ulong fractions;
#else
typedef KOKSMA_PASTE(ulong, KOKSMA_LANES_PER_ITEM) fractions;
#endif

typedef struct {
  __global const ulong *steps;
  __global const ulong *lanes;
  real origin;
  uint dim, dims;
  ulong state[KOKSMA_GENERAL_STATES];
} points;

static inline void points_seek(points *p, __global const word *switches, ulong first, ulong n, ulong seed,
                               uint replicate, uint lane) {
  __global const ulong *words = (__global const ulong *)(switches + KOKSMA_GENERAL_TABLE);
  p->dims = (uint)switches[KOKSMA_GENERAL_DIM];
  __global const ulong *starts = words + words[2] + (ulong)replicate * p->dims;
  p->steps = words + words[0];
  p->lanes = words + words[1] + lane;
  p->origin = general_origin(switches);
  p->dim = 0;
  for (uint d = 0; d < p->dims; ++d) p->state[d] = (first >> 4) * p->steps[d] + starts[d];
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
  const fractions x = load_lanes(p->lanes + d * KOKSMA_LANES) + p->state[d];
#if KOKSMA_FP64
  return general_unit(x, p->origin);
#elif KOKSMA_LANES_PER_ITEM == 1
  return general_unit((word)(x >> 32), p->origin);
#else
#define KOKSMA_AS_HALVES KOKSMA_PASTE(as_uint, KOKSMA_LANES_PER_ITEM)
  return general_unit((bits)(KOKSMA_AS_HALVES(x.lo).odd, KOKSMA_AS_HALVES(x.hi).odd), p->origin);
#endif
}

static inline void points_step(points *p) {
  for (uint d = 0; d < p->dims; ++d) p->state[d] += p->steps[d];
  p->dim = 0;
}
