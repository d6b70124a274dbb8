// stratified: one point in each cell of a grid. Table: [0] columns a, [1] rows b, then for every replicate and grid
// [2] the key and step of its random order.
// KOKSMA_STRATIFIED_PAIRS 0: the m^d cells of the whole cube, a = b = m; cell number c has digits of base m, dimension 0
// the fastest.
//   KOKSMA_STRATIFIED_JITTER 0: sample i is the centre of cell i, (k + 1/2) / m cut off to the coordinate's bits.
//   KOKSMA_STRATIFIED_JITTER 1: a uniform point of its cell (Cook 1986); the cells come in random order, so that every
//   sample by itself is uniform over the cube.
// KOKSMA_STRATIFIED_DRAWS 2: samples 2i and 2i + 1 are two uniform points of the same cell, N = 2 m^d.
// KOKSMA_STRATIFIED_PAIRS 1: the a x b cells of dimensions (0,1), of (2,3), ..., each in a random order of its own, and
// N strata of an odd last dimension: patterns of few dimensions, associated at random (Cook 1986; Pharr, Jakob &
// Humphreys, Physically Based Rendering, section 7.3). Even dimensions have a strata, odd ones b.
typedef struct {
#if KOKSMA_STRATIFIED_JITTER
  bits jitter[4];  // of the coordinates at hand
  bijection order;
  __global const word *keys;
#endif
#if KOKSMA_STRATIFIED_PAIRS
  strata all;
  strata rows;
#endif
  strata columns;
  words32 cell;  // its number, less the digits of the dimensions drawn
  ulong index;   // of the first lane of this item
  ulong seed;
  uint replicate;
  uint dim;
} points;

#if KOKSMA_STRATIFIED_PAIRS
#define KOKSMA_STRATIFIED_GRIDS ((KOKSMA_DIM + 1) / 2)
#else
#define KOKSMA_STRATIFIED_GRIDS 1
#endif

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  p->index = first + lane;
  p->seed = seed;
  p->replicate = replicate;
  p->dim = 0;
  p->columns = strata_of((uint)table[0]);
#if KOKSMA_STRATIFIED_PAIRS
  p->rows = strata_of((uint)table[1]);
  p->all = strata_of((uint)n);
#endif
#if KOKSMA_STRATIFIED_JITTER
  p->order = bijection_on(n / KOKSMA_STRATIFIED_DRAWS);
  p->keys = table + 2 + (ulong)replicate * KOKSMA_STRATIFIED_GRIDS * 2;
#endif
}

// The cell of these samples in grid g.
static inline words32 points_cell(const points *p, uint g) {
  const words32 i = (lane_numbers() + (uint)p->index) / KOKSMA_STRATIFIED_DRAWS;
#if KOKSMA_STRATIFIED_JITTER
  return permute(i, p->order, (words32)(uint)p->keys[2 * g], (words32)(uint)p->keys[2 * g + 1]);
#else
  return i;
#endif
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
#if KOKSMA_STRATIFIED_JITTER
  if ((d & 3) == 0) random_words(p->index, p->seed, p->replicate, 7, d / 4, p->jitter);
  const bits u = p->jitter[d & 3];
#else
  const bits u = (bits)((word)1 << (8 * sizeof(word) - 1));
#endif
#if KOKSMA_STRATIFIED_PAIRS
  if ((d & 1) == 1) return in_stratum(p->cell, u, p->rows);
  p->cell = points_cell(p, d / 2);
  if (d + 1 == KOKSMA_DIM) return in_stratum(p->cell, u, p->all);
#else
  if (d == 0) p->cell = points_cell(p, 0);
#endif
  words32 digit;
  p->cell = divide_words((words32)0, p->cell, p->columns, &digit);
  return in_stratum(digit, u, p->columns);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
