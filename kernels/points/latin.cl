// latin: Latin hypercube samples (McKay, Beckman & Conover 1979), N-rooks in computer graphics (Shirley 1991):
// x_j(i) = (pi_j(i) + u) / N, an independent random permutation pi_j of [0, N) for every dimension and replicate.
// Table: key and step [D][2] of the permutations per replicate.
typedef struct {
  bits jitter[4];  // of the coordinates at hand
  bijection order;
  strata rows;
  __global const word *keys;
  ulong index;  // of the first lane of this item
  ulong seed;
  uint replicate;
  uint dim;
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  p->index = first + lane;
  p->seed = seed;
  p->replicate = replicate;
  p->dim = 0;
  p->order = bijection_on(n);
  p->rows = strata_of((uint)n);
  p->keys = table + (ulong)replicate * KOKSMA_DIM * 2;
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
  if ((d & 3) == 0) random_words(p->index, p->seed, p->replicate, 7, d / 4, p->jitter);
  const words32 row = permute(lane_numbers() + (uint)p->index, p->order, (words32)(uint)p->keys[2 * d],
                              (words32)(uint)p->keys[2 * d + 1]);
  return in_stratum(row, p->jitter[d & 3], p->rows);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
