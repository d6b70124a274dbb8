// random: independent uniform points from the counter-based generator Philox4x32-10 (Salmon et al. 2011, Random123).
// Key: the 64-bit seed. Counter: (index low, index high, replicate, purpose << 24 | block), purpose 0 here.
// Coordinates 4k ... 4k+3 are one 64-bit word each: output word c of block 2k is the high half of coordinate
// 4k + c, output word c of block 2k + 1 its low half, so fp32 (which keeps the top 23 bits) computes block 2k only.
typedef struct {
  bits buffer[4];  // mantissas of the coordinates at hand
  ulong index;     // of the first lane of this item
  ulong seed;
  uint replicate;
  uint dim;
} points;

// The 64-bit products of all lanes with one constant, from the even and the odd lanes: multiply-high of vectors
// is slow on CPUs, 32 x 32 -> 64 is one instruction.
static inline void multiply_wide(words32 a, uint factor, words32 *high, words32 *low) {
#if KOKSMA_LANES_PER_ITEM == 1
  *high = mul_hi(a, factor);
  *low = a * factor;
#else
#if KOKSMA_LANES_PER_ITEM == 4
  typedef ulong2 wide;
#define KOKSMA_AS_WIDE as_ulong2
#elif KOKSMA_LANES_PER_ITEM == 8
  typedef ulong4 wide;
#define KOKSMA_AS_WIDE as_ulong4
#else
  typedef ulong8 wide;
#define KOKSMA_AS_WIDE as_ulong8
#endif
#define KOKSMA_AS_WORDS32 KOKSMA_PASTE(as_uint, KOKSMA_LANES_PER_ITEM)
  const wide even = (KOKSMA_AS_WIDE(a) & 0xFFFFFFFFUL) * (ulong)factor;
  const wide odd = (KOKSMA_AS_WIDE(a) >> 32) * (ulong)factor;
  *high = KOKSMA_AS_WORDS32(even >> 32 | (odd & 0xFFFFFFFF00000000UL));
  *low = KOKSMA_AS_WORDS32((even & 0xFFFFFFFFUL) | odd << 32);
#endif
}

static inline void philox(const points *p, uint block, words32 out[4]) {
  uint key0 = (uint)p->seed, key1 = (uint)(p->seed >> 32);
  // index is a multiple of W and W divides 2^32: the low half never carries inside an item.
  words32 c0 = lane_numbers() + (uint)p->index;
  words32 c1 = (words32)(uint)(p->index >> 32), c2 = (words32)p->replicate, c3 = (words32)block;
  for (uint round = 0; round < 10; ++round) {
    words32 high0, low0, high1, low1;
    multiply_wide(c0, 0xD2511F53u, &high0, &low0);
    multiply_wide(c2, 0xCD9E8D57u, &high1, &low1);
    c0 = high1 ^ c1 ^ key0;
    c1 = low1;
    c2 = high0 ^ c3 ^ key1;
    c3 = low0;
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  out[0] = c0;
  out[1] = c1;
  out[2] = c2;
  out[3] = c3;
}

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
    words32 high[4];
    philox(p, p->dim / 4 * 2, high);
#if KOKSMA_FP64
    words32 low[4];
    philox(p, p->dim / 4 * 2 + 1, low);
    for (uint i = 0; i < 4; ++i) p->buffer[i] = KOKSMA_TO_BITS(high[i]) << 20 | KOKSMA_TO_BITS(low[i]) >> 12;
#else
    for (uint i = 0; i < 4; ++i) p->buffer[i] = high[i] >> 9;
#endif
  }
  ++p->dim;
  return unit_from_mantissa(p->buffer[slot] | (word)KOKSMA_ONE_PATTERN);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
}

static inline uint points_drawn(const points *p) { return p->dim; }
