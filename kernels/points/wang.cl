// wang: a tiling of the unit torus by T x T Wang tiles, T = 2^level the smallest with room for n points. Every tile
// has `ranks` points in a progressive order, and sample i is point i >> 2 level of a tile: the same rank in all tiles
// before the next one. The colours of a tile's four edges are hashed from where the edges are, so that tilings are
// valid, aperiodic within the square, and need no search (Cohen, Shade, Hiller & Deussen 2003; Kopf, Cohen-Or, Deussen
// & Lischinski 2006, section 3). Then the whole square is shifted at random modulo 1.
// A tile owns what lies about its lower left corner, its left and its lower edge, and its interior.
// Keys, per replicate: quartets 0 and 1 of purpose 11, index 0: shift x, shift y, first tile, colours.
// Table (words): [0] log2 of the ranks; then x and y [type][rank] in units of 2^-30 tiles, plus one tile; type =
// left | right << 1 | lower << 2 | upper << 3. Coordinates have 32 bits, so fp32 and fp64 draw the same points.
#if KOKSMA_LANES_PER_ITEM == 1
#define KOKSMA_WANG_WORDS32 convert_uint
#else
#define KOKSMA_WANG_WORDS32 KOKSMA_PASTE(convert_uint, KOKSMA_LANES_PER_ITEM)
#endif

typedef struct {
  __global const word *table;
  word shift[2];
  bits y;       // of the present sample
  uint tiling;  // key of the colours
  uint first;   // key of the order of the tiles
  uint index;   // of the first lane
  uint level;
  uint dim;  // coordinates drawn
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  bits random[4];
  random_quartet((words32)(0u), (words32)(0u), seed, replicate, 11, 0, random);
  word lanes[4][KOKSMA_LANES_PER_ITEM];  // all the same
  for (uint i = 0; i < 4; ++i) store_lanes(random[i], lanes[i]);
  const uint high = 8 * sizeof(word) - 32;
  p->shift[0] = lanes[0][0];
  p->shift[1] = lanes[1][0];
  p->first = (uint)(lanes[2][0] >> high);
  p->tiling = (uint)(lanes[3][0] >> high);
  p->table = table;
  p->index = (uint)first + lane;
  p->level = 0;
  while ((ulong)1 << (uint)table[0] + 2 * p->level < n) ++p->level;
  p->dim = 0;
}

// A colour, 0 or 1, of the edge at (x, y): a bit of a hash with low bias (C. Wellons, Prospecting for hash functions,
// 2018), into which the key comes after the first round, so that two keys do not give the same colours elsewhere.
static inline words32 colour(words32 x, words32 y, uint level, uint horizontal, uint key) {
  words32 h = (y << level | x) ^ horizontal << 31;
  h ^= h >> 16;
  h *= 0x7FEB352Du;
  h += key;
  h ^= h >> 15;
  h *= 0x846CA68Bu;
  return h >> 31;
}

// Every other bit, from bit 0 on.
static inline words32 even_bits(words32 x) {
  x &= 0x55555555u;
  x = (x | x >> 1) & 0x33333333u;
  x = (x | x >> 2) & 0x0F0F0F0Fu;
  x = (x | x >> 4) & 0x00FF00FFu;
  return (x | x >> 8) & 0x0000FFFFu;
}

static inline words32 gather32(__global const word *column, words32 at) {
  uint places[KOKSMA_LANES_PER_ITEM];
  store_lanes(at, places);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) places[l] = (uint)column[places[l]];
  return load_lanes(places);
}

// (tile - 1 + within) / T as a fraction of 32 bits; within has 30 bits after the point.
static inline bits placed(words32 tile, words32 within, uint level) {
  words32 inside = within << 2;
  if (level == 1) inside = within << 1;
  if (level > 1) inside = within >> (level - 2);
  return KOKSMA_TO_BITS(((tile - 1u) << 1 << (31 - level)) + inside) << (word)(8 * sizeof(word) - 32);
}

static inline real points_next(points *p) {
  if (p->dim++ > 0) return unit_from_word(p->y + p->shift[1]);
  const uint level = p->level, log2_ranks = (uint)p->table[0], last = (1u << level) - 1;
  const words32 i = lane_numbers() + p->index;
  // The low bits of i say which quarter of the square, so that the tiles of a rank come well spread.
  const uint unused = 8 * sizeof(word) - 32;
  const words32 morton = KOKSMA_WANG_WORDS32(reverse_bits(KOKSMA_TO_BITS(i) << (word)unused)) >> 1 >> (31 - 2 * level);
  const words32 x = even_bits(morton) ^ (p->first & last), y = even_bits(morton >> 1) ^ (p->first >> 16 & last);
  // Beyond the set's last point, where nothing is counted, ranks begin again.
  const words32 rank = i >> 2 * level & ((1u << log2_ranks) - 1);
  const words32 type = colour(x, y, level, 0, p->tiling) | colour((x + 1u) & last, y, level, 0, p->tiling) << 1 |
                       colour(x, y, level, 1, p->tiling) << 2 | colour(x, (y + 1u) & last, level, 1, p->tiling) << 3;
  const words32 at = type << log2_ranks | rank;
  p->y = placed(y, gather32(p->table + 1 + (16u << log2_ranks), at), level);
  return unit_from_word(placed(x, gather32(p->table + 1, at), level) + p->shift[0]);
}

static inline void points_step(points *p) {
  p->dim = 0;
  p->index += KOKSMA_LANES;
}

static inline uint points_drawn(const points *p) { return p->dim; }
