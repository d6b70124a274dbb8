// table: a set of K points, computed or read before the kernel runs, and its randomized copies ("tiles"): sample i
// is point i mod K of tile i / K.
// KOKSMA_TABLE_TILES
//   0: the points as they are; there is one tile
//   1: a random shift modulo 1 per tile (Cranley & Patterson 1976), which keeps all toroidal distances
//   2: nested uniform (Owen) scrambling per tile and coordinate, which keeps all elementary intervals; above two
//      dimensions every further pair of coordinates takes the two-dimensional set again, scrambled anew and, inside
//      every [2^k, 2^(k+1)), in another order, so that the prefixes of 2^k points stay the sets they are
// Shifts and keys: random_quartet of purpose 11, index = tile.
// Table (words): [0] K, a multiple of 16; then coordinates [C][K], top-aligned fractions, C = KOKSMA_DIM; where tiles
// are scrambled C = 2 and the words are bit-reversed. fp32 words are the top halves of those of fp64, and the sets that
// are shifted have 32 bits, so no carry comes from below.
#if KOKSMA_TABLE_TILES == 0
#define KOKSMA_TABLE_KEYS 1
#elif KOKSMA_TABLE_TILES == 1
#define KOKSMA_TABLE_KEYS (KOKSMA_DIM + 3)  // a shift per coordinate, in whole quartets
#else
#define KOKSMA_TABLE_KEYS (4 * (KOKSMA_DIM + 1))  // per pair: addend, factor, addend, factor; those of the order, 2 unused
#endif

#if KOKSMA_LANES_PER_ITEM == 1
#define KOKSMA_TABLE_WORDS32 convert_uint
#else
#define KOKSMA_TABLE_WORDS32 KOKSMA_PASTE(convert_uint, KOKSMA_LANES_PER_ITEM)
#endif

typedef struct {
  __global const word *coordinates;
  word keys[KOKSMA_TABLE_KEYS];  // of the present tile
  ulong tile;
  ulong seed;
  uint size;  // K
  uint k;     // place of the first lane in its tile
  uint replicate;
  uint dim;  // coordinates drawn
} points;

static inline void enter_tile(points *p) {
#if KOKSMA_TABLE_TILES
#if KOKSMA_TABLE_TILES == 1
  const uint quartets = (KOKSMA_DIM + 3) / 4;
#else
  const uint quartets = (KOKSMA_DIM + 1) / 2 * 2;
#endif
  for (uint q = 0; q < quartets; ++q) {
    bits random[4];
    random_quartet((words32)(uint)p->tile, (words32)(uint)(p->tile >> 32), p->seed, p->replicate, 11, q, 4, random);
    for (uint i = 0; i < 4; ++i) {
      word lanes[KOKSMA_LANES_PER_ITEM];  // all the same
      store_lanes(random[i], lanes);
#if KOKSMA_FP64 && KOKSMA_TABLE_TILES == 2
      // The low half of a hash of 64 bits is the hash of 32: it takes what fp32 draws, the high half.
      p->keys[4 * q + i] = lanes[0] << 32 | lanes[0] >> 32;
#else
      p->keys[4 * q + i] = lanes[0];
#endif
    }
  }
#endif
}

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  p->coordinates = table + 1;
  p->size = (uint)table[0];
  p->tile = first / p->size;
  p->k = (uint)(first % p->size) + lane;
  p->seed = seed;
  p->replicate = replicate;
  p->dim = 0;
  enter_tile(p);
}

#if KOKSMA_TABLE_TILES == 2
// The place among the same 2^k <= i < 2^(k+1) where lanes find their point: nested uniform scrambling of the index,
// most significant bit first, with the bits from the leading one upwards put back. What is below them stays a
// bijection, as it depends on them and on itself only.
static inline words32 reordered(words32 i, word addend, word factor) {
  const uint unused = 8 * sizeof(word) - 32;
  const bits scrambled =
      reverse_bits(owen_hash(reverse_bits(KOKSMA_TO_BITS(i) << (word)unused), addend, factor)) >> (word)unused;
  words32 below = i >> 1;
  below |= below >> 1;
  below |= below >> 2;
  below |= below >> 4;
  below |= below >> 8;
  below |= below >> 16;
  return i ^ ((i ^ KOKSMA_TABLE_WORDS32(scrambled)) & below);
}

static inline bits gather(__global const word *column, words32 at) {
  uint places[KOKSMA_LANES_PER_ITEM];
  word words[KOKSMA_LANES_PER_ITEM];
  store_lanes(at, places);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) words[l] = column[places[l]];
  return load_lanes(words);
}

static inline real points_next(points *p) {
  const uint d = p->dim++, pair = d / 2, axis = d % 2;
  __global const word *column = p->coordinates + (ulong)axis * p->size;
  const word *key = p->keys + 8 * pair;
  bits x;
  if (pair == 0)
    x = load_lanes(column + p->k);
  else
    x = gather(column, reordered(lane_numbers() + p->k, key[4], key[5] | 1));
  return unit_from_word(reverse_bits(owen_hash(x, key[2 * axis], key[2 * axis + 1] | 1)));
}
#else
static inline real points_next(points *p) {
  const uint d = p->dim++;
  const bits x = load_lanes(p->coordinates + (ulong)d * p->size + p->k);
#if KOKSMA_TABLE_TILES == 1
  return unit_from_word(x + p->keys[d]);
#else
  return unit_from_word(x);
#endif
}
#endif

static inline void points_step(points *p) {
  p->dim = 0;
  p->k += KOKSMA_LANES;
  if (p->k < p->size) return;
  p->k -= p->size;
  ++p->tile;
  enter_tile(p);
}

static inline uint points_drawn(const points *p) { return p->dim; }
