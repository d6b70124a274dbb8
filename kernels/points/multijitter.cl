// multijitter: N = a b points of dimensions (0,1), of (2,3), ..., one in each cell of a grid of a columns and b rows and
// one in each of N columns and N rows. The point of cell (column, row) lies in substratum p(row) of its column, p a
// permutation of [0, b), and in substratum q(column) of its row, q one of [0, a); so no two cells share one.
// KOKSMA_MULTIJITTER_CORRELATED 0: another p for every column and q for every row (Chiu, Shirley & Wang, Multi-jittered
//   sampling, Graphics Gems IV, 1994).
// KOKSMA_MULTIJITTER_CORRELATED 1: one p and one q for all (Kensler, Correlated multi-jittered sampling, Pixar 13-01,
//   2013), with true permutations instead of Kensler's hash. All points of a row then share their place in the columns,
//   which does not average out along the row: at d = 2 errors of smooth integrands fall as N^-3/4, not as N^-1 (measured
//   -0.74 against -1.05, 2026-11-24).
// The cells of every pair come in a random order of its own; an odd last dimension has N strata in random order.
// Table: [0] a, [1] b; then per replicate and pair the keys and steps of order, p and q: [pair][3][2].
typedef struct {
  bits jitter[4];  // of the coordinates at hand
  bijection order, down, across;
  strata strips;
  strata columns;
  __global const word *keys;
  words32 y;  // the row strip, known once the column strip is drawn
  ulong index;  // of the first lane of this item
  ulong seed;
  uint rows;
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
  p->across = bijection_on(table[0]);
  p->down = bijection_on(table[1]);
  p->columns = strata_of((uint)table[0]);
  p->rows = (uint)table[1];
  p->strips = strata_of((uint)n);
  p->keys = table + 2 + (ulong)replicate * ((KOKSMA_DIM + 1) / 2) * 6;
}

// Permutation `which` of a pair's table, anew for every line (column or row) where the lines have their own.
static inline words32 points_substratum(words32 x, words32 line, bijection s, __global const word *key) {
#if KOKSMA_MULTIJITTER_CORRELATED
  return permute(x, s, (words32)(uint)key[0], (words32)(uint)key[1]);
#else
  const words32 own = avalanche(line + (uint)key[0]);
  return permute(x, s, own, avalanche(own + (uint)key[1]) | 1u);
#endif
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
  if ((d & 3) == 0) random_words(p->index, p->seed, p->replicate, 7, d / 4, p->jitter);
  const bits u = p->jitter[d & 3];
  if ((d & 1) == 1) return in_stratum(p->y, u, p->strips);

  __global const word *keys = p->keys + d / 2 * 6;
  const words32 cell =
      permute(lane_numbers() + (uint)p->index, p->order, (words32)(uint)keys[0], (words32)(uint)keys[1]);
  if (d + 1 == KOKSMA_DIM) return in_stratum(cell, u, p->strips);
  words32 column;
  const words32 row = divide_words((words32)0, cell, p->columns, &column);
  const words32 x = column * p->rows + points_substratum(row, column, p->down, keys + 2);
  p->y = row * p->columns.n + points_substratum(column, row, p->across, keys + 4);
  return in_stratum(x, u, p->strips);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
