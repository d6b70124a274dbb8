// padded-net: dimensions (0,1), (2,3), ... are N = 2^m points of the base-2 (0,2)-sequence each, an odd last dimension the
// van der Corput sequence; every coordinate has its own nested uniform scramble (parts/owen.cl), and every pair but the
// first, which keeps the natural order of the sequence, takes its points in a random order of its own.
// Words are bit-reversed as owen.cl wants them: reversed, the van der Corput word of s is s itself, and the second
// coordinate is Pascal's triangle modulo 2 times the bits of s (Sobol' 1967; Kollig & Keller, Efficient multidimensional
// sampling, 2002).
// Table per replicate: key and step [pairs][2] of the orders, then addend and factor [D][2] of the scrambles.
typedef struct {
  bits s;  // the present pair's index in its sequence
  bijection order;
  __global const word *orders;
  __global const word *scrambles;
  ulong index;  // of the first lane of this item
  uint dim;
} points;

// Bit r of the result is the sum over k of binom(k, r) s_k modulo 2. By Lucas' theorem binom(k, r) is odd where the
// binary digits of r are among those of k: a sum over supersets, one step per digit. Indices have 32 bits.
static inline bits pascal_times(bits s) {
  s ^= s >> 1 & (word)0x5555555555555555UL;
  s ^= s >> 2 & (word)0x3333333333333333UL;
  s ^= s >> 4 & (word)0x0F0F0F0F0F0F0F0FUL;
  s ^= s >> 8 & (word)0x00FF00FF00FF00FFUL;
  return s ^ (s >> 16 & (word)0x0000FFFF0000FFFFUL);
}

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  const uint pairs = (KOKSMA_DIM + 1) / 2;
  p->index = first + lane;
  p->dim = 0;
  p->order = bijection_on(n);
  p->orders = table + (ulong)replicate * (pairs + KOKSMA_DIM) * 2;
  p->scrambles = p->orders + pairs * 2;
}

static inline real points_next(points *p) {
  const uint d = p->dim++;
  bits reversed;
  if ((d & 1) == 1) {
    reversed = pascal_times(p->s);
  } else {
    words32 i = lane_numbers() + (uint)p->index;
    if (d > 0) i = permute(i, p->order, (words32)(uint)p->orders[d], (words32)(uint)p->orders[d + 1]);
    p->s = KOKSMA_TO_BITS(i);
    reversed = p->s;
  }
  return unit_from_word(reverse_bits(owen_hash(reversed, p->scrambles[2 * d], p->scrambles[2 * d + 1])));
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
