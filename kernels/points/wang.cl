// wang: points on recursive Wang tiles (Kopf, Cohen-Or, Deussen & Lischinski 2006). The unit torus is 4 x 4 tiles whose
// edges have random colours; a rule cuts every tile into 4 x 4 cells that are tiles again, and so on. A tile has 256
// points in a progressive order, of which ranks 0 ... 15 are its own and the others become its cells' own: the first
// 256 16^k points of the sequence are all the points of level k, exactly, and are among those of the next level.
// Sample i in base 16: the two leading digits are the rank (one digit below i = 256), the others lead to the tile: the
// last says which of the 4 x 4, the one before which of its cells, and so on, in the order of a dither matrix (B. E.
// Bayer, ICC 1973). Then the whole square is shifted at random modulo 1.
// Keys, per replicate: quartet 0 of purpose 11, index 0: shift x, shift y, colours of the 4 x 4 tiles' edges (high half).
// Table (words): the rule, [types 0 ... 7, types 8 ... 15][cell], 4 bits a type; then x and y [rank][type] in units of
// 2^-32 tiles (items of nearby indices share the rank). Type = left | right << 1 | lower << 2 | upper << 3; cell =
// column | row << 2.

typedef struct {
  __global const word *table;
  word shift[2];
  words32 type, column, row;  // of the lanes' tiles among the 4 x 4: steps of 16 indices do not change them
  bits y;                     // of the present sample
  ulong index;                // of the first lane
  uint dim;                   // coordinates drawn
} points;

// Column and row (of 4) of the k-th cell in dither order: bits 0 and 1 say the quarter, bits 2 and 3 the quarter's.
#define KOKSMA_WANG_COLUMN(k) (((k) & 1u) << 1 | ((k) >> 2 & 1u))
#define KOKSMA_WANG_ROW(k) KOKSMA_WANG_COLUMN((k) ^ (k) >> 1)

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  bits random[4];
  random_quartet((words32)(0u), (words32)(0u), seed, replicate, 11, 0, 4, random);
  word lanes[3][KOKSMA_LANES_PER_ITEM];  // all the same
  for (uint i = 0; i < 3; ++i) store_lanes(random[i], lanes[i]);
  p->shift[0] = lanes[0][0];
  p->shift[1] = lanes[1][0];
  p->table = table;
  p->index = first + lane;
  p->dim = 0;
  // A bit for every vertical and every horizontal edge.
  const uint colours = (uint)(lanes[2][0] >> (8 * sizeof(word) - 32));
  const words32 k = lane_numbers() + lane;
  p->column = KOKSMA_WANG_COLUMN(k);
  p->row = KOKSMA_WANG_ROW(k);
  const words32 tile = p->column | p->row << 2;
  const words32 right = (p->column + 1u & 3u) | p->row << 2, upper = tile + 4u & 15u;
  p->type = ((words32)(colours) >> tile & 1u) | ((words32)(colours) >> right & 1u) << 1 |
            ((words32)(colours) >> (tile + 16u) & 1u) << 2 | ((words32)(colours) >> (upper + 16u) & 1u) << 3;
}

// The types of this cell in tiles of these types.
static inline words32 cell_types(__global const word *rule, uint cell, words32 type) {
  const uint low = (uint)rule[cell], high = (uint)rule[16 + cell];
  const words32 chosen = low ^ (low ^ high) * (type >> 3);
  return chosen >> ((type & 7u) << 2) & 15u;
}

static inline words32 gather32(__global const word *column, words32 at) {
  uint places[KOKSMA_LANES_PER_ITEM];
  store_lanes(at, places);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) places[l] = (uint)column[places[l]];
  return load_lanes(places);
}

// A place within a tile of level `levels` - 1, which has 4^levels columns, shifted. Both precisions must draw the same
// point and the low half must be as random as the high one: it is XORed, so that nothing is carried out of it.
static inline bits placed(words32 tile, words32 within, uint levels, word shift) {
#if KOKSMA_FP64
  const bits place = KOKSMA_TO_BITS(tile) << (word)(64 - 2 * levels) | KOKSMA_TO_BITS(within) << (word)(32 - 2 * levels);
  return place + (shift & 0xFFFFFFFF00000000UL) ^ (shift & 0xFFFFFFFFUL);
#else
  return (tile << (32 - 2 * levels) | within >> 2 * levels) + shift;
#endif
}

static inline real points_next(points *p) {
  if (p->dim++ > 0) return unit_from_word(p->y);
  const ulong i = p->index;
  // 16^(levels + 1) <= i < 16^(levels + 2), but all below 256 are on level 0.
  const uint levels = (uint)(63 - clz(i | 256)) / 4 - 1;
  words32 type = p->type;
  // The lanes differ in the last digit only.
  uint column = 0, row = 0;
  for (uint level = 1; level < levels; ++level) {
    const uint k = (uint)(i >> 4 * level) & 15u;
    const uint in_column = KOKSMA_WANG_COLUMN(k), in_row = KOKSMA_WANG_ROW(k);
    type = cell_types(p->table, in_column | in_row << 2, type);
    column = column << 2 | in_column;
    row = row << 2 | in_row;
  }
  const words32 at = type | (uint)(i >> 4 * levels) << 4;
  const uint lowest = 2 * (levels - 1);
  p->y = placed(p->row << lowest | row, gather32(p->table + 32 + 4096, at), levels, p->shift[1]);
  return unit_from_word(placed(p->column << lowest | column, gather32(p->table + 32, at), levels, p->shift[0]));
}

static inline void points_step(points *p) {
  p->dim = 0;
  p->index += KOKSMA_LANES;
}

static inline uint points_drawn(const points *p) { return p->dim; }
