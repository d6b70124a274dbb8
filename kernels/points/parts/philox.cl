// philox: words of the counter-based generator Philox4x32-10 (Salmon et al. 2011, Random123) for W consecutive
// sample indices. Key: the 64-bit seed. Counter: (index low, index high, replicate, purpose << 24 | block), one
// purpose per use (kernels/README.md, "Random streams").
// The rounds run on 64-bit slots that hold one word each, in the low half: the even and the odd lanes apart, so that
// 32 x 32 -> 64 is one instruction (vpmuludq) that takes its factors where they are and leaves both words of the next
// round there: a product's low half is one as it stands, its high half one shift away. What is in the high halves of
// the slots never counts. (Multiply-high of vectors is slow on CPUs, and shuffles in every round cost a third.)
#if KOKSMA_LANES_PER_ITEM == 16
typedef ulong8 philox_slots;
#define KOKSMA_AS_SLOTS as_ulong8
#define KOKSMA_TO_SLOTS convert_ulong8
#define KOKSMA_AS_WORDS32 as_uint16
#elif KOKSMA_LANES_PER_ITEM == 8
typedef ulong4 philox_slots;
#define KOKSMA_AS_SLOTS as_ulong4
#define KOKSMA_TO_SLOTS convert_ulong4
#define KOKSMA_AS_WORDS32 as_uint8
#elif KOKSMA_LANES_PER_ITEM == 4
typedef ulong2 philox_slots;
#define KOKSMA_AS_SLOTS as_ulong2
#define KOKSMA_TO_SLOTS convert_ulong2
#define KOKSMA_AS_WORDS32 as_uint4
#else
typedef ulong philox_slots;
#endif

// The 64-bit products of all lanes with one constant, from the even and the odd lanes, for other pieces.
static inline void multiply_wide(words32 a, uint factor, words32 *high, words32 *low) {
#if KOKSMA_LANES_PER_ITEM == 1
  *high = mul_hi(a, factor);
#else
  const philox_slots even = (KOKSMA_AS_SLOTS(a) & 0xFFFFFFFFUL) * (ulong)factor;
  const philox_slots odd = (KOKSMA_AS_SLOTS(a) >> 32) * (ulong)factor;
  *high = KOKSMA_AS_WORDS32(even >> 32 | (odd & 0xFFFFFFFF00000000UL));
#endif
  // Not from the products: clang turns odd << 32 into a third, slow 64-bit multiplication.
  *low = a * factor;
}

// always_inline: called twice, it would stay a function with its vectors in memory, at a third of the speed.
__attribute__((always_inline)) static inline void philox_slot_rounds(philox_slots c0, philox_slots c1, ulong seed,
                                                                     uint replicate, uint last, philox_slots out[4]) {
  uint key0 = (uint)seed, key1 = (uint)(seed >> 32);
  philox_slots c2 = (philox_slots)(ulong)replicate, c3 = (philox_slots)(ulong)last;
  // Unrolled, the keys of all rounds are constants of the loop over the samples.
  _Pragma("unroll")
  for (uint round = 0; round < 10; ++round) {
    const philox_slots product0 = (c0 & 0xFFFFFFFFUL) * 0xD2511F53UL;
    const philox_slots product1 = (c2 & 0xFFFFFFFFUL) * 0xCD9E8D57UL;
    c0 = product1 >> 32 ^ c1 ^ (ulong)key0;
    c1 = product1;
    c2 = product0 >> 32 ^ c3 ^ (ulong)key1;
    c3 = product0;
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  out[0] = c0;
  out[1] = c1;
  out[2] = c2;
  out[3] = c3;
}

// Output words of the lanes' indices; c0 and c1 are the counters' low and high index words.
__attribute__((always_inline)) static inline void philox_rounds(words32 c0, words32 c1, ulong seed, uint replicate,
                                                                uint last, words32 out[4]) {
#if KOKSMA_LANES_PER_ITEM == 1
  philox_slots words[4];
  philox_slot_rounds(c0, c1, seed, replicate, last, words);
  for (uint i = 0; i < 4; ++i) out[i] = (uint)words[i];
#else
  philox_slots even[4], odd[4];
  philox_slot_rounds(KOKSMA_AS_SLOTS(c0), KOKSMA_AS_SLOTS(c1), seed, replicate, last, even);
  philox_slot_rounds(KOKSMA_AS_SLOTS(c0) >> 32, KOKSMA_AS_SLOTS(c1) >> 32, seed, replicate, last, odd);
  _Pragma("unroll")
  for (uint i = 0; i < 4; ++i) out[i] = KOKSMA_AS_WORDS32((even[i] & 0xFFFFFFFFUL) | odd[i] << 32);
#endif
}

#if KOKSMA_FP64
// Four words of 64 bits for the indices of some slots. Two blocks hold them, high halves in block 2k, low halves in
// block 2k + 1; but where one or two dimensions are left, block 2k holds both, high in outputs 0 and 1, low in 2 and 3:
// half the work at d = 1 and 2.
__attribute__((always_inline)) static inline void philox_fractions(philox_slots c0, philox_slots c1, ulong seed,
                                                                   uint replicate, uint purpose, uint k, uint left,
                                                                   philox_slots out[4]) {
  philox_slots high[4];
  philox_slot_rounds(c0, c1, seed, replicate, purpose << 24 | k * 2, high);
  if (left == 1 || left == 2) {
    out[0] = high[0] << 32 | (high[2] & 0xFFFFFFFFUL);
    out[1] = high[1] << 32 | (high[3] & 0xFFFFFFFFUL);
    return;
  }
  philox_slots low[4];
  philox_slot_rounds(c0, c1, seed, replicate, purpose << 24 | (k * 2 + 1), low);
  _Pragma("unroll")
  for (uint i = 0; i < 4; ++i) out[i] = high[i] << 32 | (low[i] & 0xFFFFFFFFUL);
}
#endif

// Four words of `bits` for lanes with the index words c0 and c1, quartet k of a purpose; left: how many dimensions there
// are from 4k on. fp32 keeps the high halves of fp64's words, so it computes block 2k only.
static inline void random_quartet(words32 c0, words32 c1, ulong seed, uint replicate, uint purpose, uint k, uint left,
                                  bits out[4]) {
#if !KOKSMA_FP64
  philox_rounds(c0, c1, seed, replicate, purpose << 24 | k * 2, out);
#elif KOKSMA_LANES_PER_ITEM == 1
  philox_fractions(c0, c1, seed, replicate, purpose, k, left, out);
#else
  // Lanes as they come: a word fills a slot, so nothing is packed, which even and odd lanes cost a sixth of the time.
  philox_slots first[4], second[4];
  philox_fractions(KOKSMA_TO_SLOTS(c0.lo), KOKSMA_TO_SLOTS(c1.lo), seed, replicate, purpose, k, left, first);
  philox_fractions(KOKSMA_TO_SLOTS(c0.hi), KOKSMA_TO_SLOTS(c1.hi), seed, replicate, purpose, k, left, second);
  _Pragma("unroll")
  for (uint i = 0; i < 4; ++i) out[i] = (bits)(first[i], second[i]);
#endif
}

// One word each for dimensions 4k ... 4k+3, as far as there are so many.
static inline void random_dimensions(words32 c0, words32 c1, ulong seed, uint replicate, uint purpose, uint k,
                                     bits out[4]) {
#if KOKSMA_DIM % 4 == 1 || KOKSMA_DIM % 4 == 2
  random_quartet(c0, c1, seed, replicate, purpose, k, KOKSMA_DIM - 4 * k, out);
#else
  random_quartet(c0, c1, seed, replicate, purpose, k, 4, out);
#endif
}

// random_dimensions of the lanes' own consecutive indices, `index` that of the first lane. It is a multiple of W and W
// divides 2^32, so the low half never carries inside an item.
static inline void random_words(ulong index, ulong seed, uint replicate, uint purpose, uint k, bits out[4]) {
  random_dimensions(lane_numbers() + (uint)index, (words32)(uint)(index >> 32), seed, replicate, purpose, k, out);
}
