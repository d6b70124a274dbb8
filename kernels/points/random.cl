// random: independent uniform points from the counter-based generator Philox4x32-10 (parts/philox.cl), purpose 0.
// Coordinates 4k ... 4k+3 of a sample are quartet k of its index.
// KOKSMA_RANDOM_ANTITHETIC: samples 2i and 2i + 1 are x and 1 - x, x the point of index i (Hammersley & Morton
// 1956); on the centred grid the reflection flips every bit.
typedef struct {
  bits buffer[4];  // mantissas of the coordinates at hand
  ulong index;     // of the first lane of this item
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
}

static inline real points_next(points *p) {
  const uint slot = p->dim & 3;
  if (slot == 0) {
#if KOKSMA_RANDOM_ANTITHETIC
    // Halving the index of a lane: index is a multiple of W, and an item of one lane may hold an odd one.
    const words32 pair = ((lane_numbers() + (uint)(p->index & 1)) >> 1) + (uint)(p->index >> 1);
    random_dimensions(pair, (words32)(uint)(p->index >> 33), p->seed, p->replicate, 0, p->dim / 4, p->buffer);
    const bits odd = KOKSMA_TO_BITS((lane_numbers() + (uint)p->index) & 1u);
    for (uint i = 0; i < 4; ++i) p->buffer[i] ^= (word)0 - odd;
#else
    random_words(p->index, p->seed, p->replicate, 0, p->dim / 4, p->buffer);
#endif
  }
  ++p->dim;
  return unit_from_word(p->buffer[slot]);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
