// rotate.cl: a random shift modulo 1 of every coordinate (Cranley & Patterson 1976), around the exact points
// of any family; comes after it where the sampler was asked for with randomize=rotate. prelude.cl has renamed
// the family's slots to unrotated_*.
// x = k 2^-m and 1 - u, u = (j + 1/2) 2^-m, are multiples of 2^-(m+1) below 1 in size, and so are their difference
// and that plus 1: nothing rounds, and the coordinate is (l + 1/2) 2^-m in (0,1).
// In fp32 point and shift are cut to 23 bits each, so that a coordinate may be one unit of 2^-23 below fp64's.
// Table: [0] where the family's table begins; then the bits of 1 - u [D] per replicate.
#undef points
#undef points_seek
#undef points_next
#undef points_step
#undef points_drawn

typedef struct {
  __global const scalar *complements;
  unrotated_points inner;
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  unrotated_seek(&p->inner, table + table[0], first, n, seed, replicate, lane);
  p->complements = (__global const scalar *)(table + 1) + (ulong)replicate * KOKSMA_DIM;
}

static inline real points_next(points *p) {
  const real complement = (real)p->complements[unrotated_drawn(&p->inner)];
  const real x = unrotated_next(&p->inner) - complement;
  return x + select_real(x < R(0.0), R(1.0), R(0.0));
}

static inline void points_step(points *p) { unrotated_step(&p->inner); }

static inline uint points_drawn(const points *p) { return unrotated_drawn(&p->inner); }
