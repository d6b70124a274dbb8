// halton-rows: words of 64 bits in both precisions, and coordinate 0 of Hammersley sets (Hammersley 1960): i/N, or
// (i + u_i)/N with independent uniform u_i, for any N.
// KOKSMA_HALTON_HAMMERSLEY: 0 none, 1 i/N, 2 (i + u_i)/N.
#if KOKSMA_LANES_PER_ITEM == 1
typedef ulong words64;
#define KOKSMA_TO_WORDS64 convert_ulong
#define KOKSMA_TO_WORDS32 convert_uint
#define KOKSMA_AS_SIGNED64 as_long
#define KOKSMA_AS_WORDS64 as_ulong
#else
typedef KOKSMA_PASTE(ulong, KOKSMA_LANES_PER_ITEM) words64;
#define KOKSMA_TO_WORDS64 KOKSMA_PASTE(convert_ulong, KOKSMA_LANES_PER_ITEM)
#define KOKSMA_TO_WORDS32 KOKSMA_PASTE(convert_uint, KOKSMA_LANES_PER_ITEM)
#define KOKSMA_AS_SIGNED64 KOKSMA_PASTE(as_long, KOKSMA_LANES_PER_ITEM)
#define KOKSMA_AS_WORDS64 KOKSMA_PASTE(as_ulong, KOKSMA_LANES_PER_ITEM)
#endif

#if KOKSMA_HALTON_HAMMERSLEY
// floor(i 2^64 / N) by exact steps with a remainder; [offset]: N, the step of 16 indices and its remainder,
// floor(2^64 / N), 64 - log2 N (0: no power of two), then quotient and remainder of 2^k, k = 0 ... 51.
// All are 64 bits, low half first where words are 32.
typedef struct {
  words64 quotient, remainder;
  ulong n, step, step_remainder, width;
  uint shift;
#if KOKSMA_HALTON_HAMMERSLEY == 2
  words32 jitter[4], jitter_low[4];
  ulong seed, index;
  uint replicate;
#endif
} rows;

static inline ulong rows_word(__global const word *table, uint k) {
#if KOKSMA_FP64
  return table[k];
#else
  return table[2 * k] | (ulong)table[2 * k + 1] << 32;
#endif
}

// quotient + remainder / N += step + step_remainder / N
static inline void rows_add(rows *f, words64 step, words64 step_remainder) {
  f->quotient += step;
  f->remainder += step_remainder;
  // All ones where the remainder reaches N; N < 2^62.
  const words64 below = KOKSMA_AS_WORDS64(KOKSMA_AS_SIGNED64(f->remainder - f->n) >> 63);
  f->quotient += 1 + below;
  f->remainder -= f->n - (below & f->n);
}

#if KOKSMA_HALTON_HAMMERSLEY == 2
// One Philox block serves the indices i, i + 16, i + 32, i + 48 of a group of 64: output (i >> 4) & 3 of counter
// (i >> 6) * 16 + (i & 15) is the high half of u_i, the same output of the next block the low half.
static inline void rows_draw(rows *f) {
  const ulong counter = f->index >> 6 << 4 | (f->index & 15);
  const words32 low = lane_numbers() + (uint)counter, high = (words32)(uint)(counter >> 32);
  const uint phase = f->index >> 4 & 3;
  philox_rounds(low, high, f->seed, f->replicate, 7u << 24, f->jitter);
#if KOKSMA_FP64
  if (f->shift > 32) philox_rounds(low, high, f->seed, f->replicate, 7u << 24 | 1, f->jitter_low);
#endif
  for (uint k = 0; k < phase; ++k) {
    for (uint c = 0; c < 3; ++c) {
      f->jitter[c] = f->jitter[c + 1];
      f->jitter_low[c] = f->jitter_low[c + 1];
    }
  }
}
#endif

static inline void rows_seek(rows *f, __global const word *table, ulong first, ulong seed, uint replicate, uint lane) {
  f->n = rows_word(table, 0);
  f->step = rows_word(table, 1);
  f->step_remainder = rows_word(table, 2);
  f->width = rows_word(table, 3);
  f->shift = (uint)rows_word(table, 4);
  ulong quotient = 0, remainder = 0;
  for (ulong k = 4, bits_left = first >> 4; bits_left != 0; ++k, bits_left >>= 1) {
    if ((bits_left & 1) == 0) continue;
    quotient += rows_word(table, 5 + 2 * k);
    remainder += rows_word(table, 6 + 2 * k);
    if (remainder >= f->n) {
      remainder -= f->n;
      ++quotient;
    }
  }
  f->quotient = (words64)quotient;
  f->remainder = (words64)remainder;
  const words64 index = KOKSMA_TO_WORDS64(lane_numbers()) + lane;
  for (uint k = 0; k < 4; ++k) {
    const words64 set = (words64)0 - (index >> k & 1);
    rows_add(f, set & rows_word(table, 5 + 2 * k), set & rows_word(table, 6 + 2 * k));
  }
#if KOKSMA_HALTON_HAMMERSLEY == 2
  f->seed = seed;
  f->replicate = replicate;
  f->index = first + lane;
  rows_draw(f);
#endif
}

static inline real rows_coordinate(const rows *f) {
  words64 w = f->quotient;
#if KOKSMA_HALTON_HAMMERSLEY == 2
  words64 u = KOKSMA_TO_WORDS64(f->jitter[0]);
  if (f->shift > 32) {
    u <<= 32;
#if KOKSMA_FP64
    u |= KOKSMA_TO_WORDS64(f->jitter_low[0]);
#endif
    w += u >> (64 - f->shift);
  } else if (f->shift != 0) {
    w += u >> (32 - f->shift);
  } else {
    // Rounded down twice, quotient + u / N stays below the true (i + u) / N. 32 bits of u in both precisions: a low
    // half could carry into fp32's bits.
    w += u * (f->width >> 32) + (u * (f->width & 0xFFFFFFFFUL) >> 32);
  }
#endif
#if KOKSMA_FP64
  return unit_from_word(w);
#else
  return unit_from_word(KOKSMA_TO_WORDS32(w >> 32));
#endif
}

static inline void rows_step(rows *f) {
  rows_add(f, (words64)f->step, (words64)f->step_remainder);
#if KOKSMA_HALTON_HAMMERSLEY == 2
  f->index += KOKSMA_LANES;
  if ((f->index & 48) == 0) {
    rows_draw(f);
  } else {
    for (uint c = 0; c < 3; ++c) {
      f->jitter[c] = f->jitter[c + 1];
      f->jitter_low[c] = f->jitter_low[c + 1];
    }
  }
#endif
}
#endif
