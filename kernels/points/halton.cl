// halton: radical inverses phi_b(i) in the prime bases (Halton 1960), with the digits permuted, folded (Halton &
// Zaremba 1969) or nested-scrambled (Owen 1995), and the Hammersley sets, whose coordinate 0 is i/N or (i + u_i)/N.
// Natural order. i = q B + r, B a power of the base: the 16 lanes are 16 consecutive r, so that their low digits come
// from one contiguous load of a table; q is the same for all of them, or one more for those beyond the wrap.
//
// Digits permuted by position (identity, random, folded): with m mantissa bits, P(i) = floor(2^m phi(i)) obeys exactly
//   P(i) = floor((t(r) 2^m + P(q)) / B),
// t(r) the integer of the reversed, permuted digits, and P(q) from the next digits. The table holds
// t 2^m div B above s = (word size - m) bits of 2^s - B + (t 2^m mod B); the word of q is (P(q) div B) << s | P(q) mod B.
// Their sum carries into the mantissa exactly when the two remainders reach B: one addition gives P(i) without error,
// in fp32 the top 23 bits of fp64's 52. Where B > 2^s the remainders are a table of their own.
// Table (words): [0] replicate stride  [1] heads offset  [2] first replicate offset  [3] hammersley offset
//   heads [bases][4]: B, offset in the replicate, levels, unused
//   per replicate and base: [0] P of the zeros above all levels, then [1] T [B + 15], (remainders [B + 15] if B > 2^s,)
//   t of level 2 [B], t of level 3 [B], ...
#if KOKSMA_HALTON_HAMMERSLEY
#define KOKSMA_HALTON_BASES (KOKSMA_DIM - 1)
#else
#define KOKSMA_HALTON_BASES KOKSMA_DIM
#endif
#define KOKSMA_HALTON_SPARE (8 * sizeof(word) - KOKSMA_MANTISSA_BITS)
// Bases from this one on exceed 2^s: 512 < 521 is the 98th prime, 4096 < 4099 the 565th.
#if KOKSMA_FP64
#define KOKSMA_HALTON_NARROW 564
#else
#define KOKSMA_HALTON_NARROW 97
#endif
// log2 of a bound on the tabulated bases (tests/halton_test.cpp), for carries out of remainders.
#define KOKSMA_HALTON_REMAINDER_BITS 14

// Levels there can be, and one: B >= 23, indices below 2^52.
#define KOKSMA_HALTON_LEVELS 14

// 64-bit words in both precisions.
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
  f->quotient = (words64)0;
  f->remainder = (words64)0;
  const words64 index = KOKSMA_TO_WORDS64(lane_numbers()) + (first + lane);
  for (uint k = 0; k < 4; ++k) {
    const words64 set = (words64)0 - (index >> k & 1);
    rows_add(f, set & rows_word(table, 5 + 2 * k), set & rows_word(table, 6 + 2 * k));
  }
  for (uint k = 4; first >> k != 0; ++k)
    if ((first >> k & 1) != 0) rows_add(f, (words64)rows_word(table, 5 + 2 * k), (words64)rows_word(table, 6 + 2 * k));
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

#if KOKSMA_HALTON_OWEN
// Base 2 is parts/owen.cl's hash of the index, which is the reversed word of phi_2(i). In the other bases the digits of r
// come from a table of nodes; on those of q, the same in all lanes, each lane walks on down the tree from its node.
// A node's state is u: the point that ends there has it for its place in the node's interval, so its first base-b
// digit is the node's permutation of 0. Digit a > 0 becomes that plus tau(a) mod b, tau a hashed permutation of
// 1 ... b - 1, and leads to a node with a new, hashed u; digit 0 leads to frac(b u). So all nodes down the path of
// zeros, infinitely many, cost nothing.
// Table: heads [bases][6]: B, offset in the replicate, base, weights offset, -1/base mod 2^16,
//   0 if no index of the set goes beyond B, else 1
//   weights: floor(2^64 / (B b^n)), n = 0, 1, ...; per replicate: base 2: addend, factor; others: places t / B of the nodes
//   [B + 15], their u [B + 15], then up to base 17 their tau [B + 15], tau(a) - 1 in bits 4 (a - 1) on; from 19 on the
//   replicate's shuffle of 1 ... b - 1 [b]. All but the heads are 64 bits, low half first.
// Bases up to here shuffle at every node.
#define KOKSMA_HALTON_PACKED 17
// The low bits of a table node's u repeat its first digit.
#define KOKSMA_HALTON_DIGIT 8191

typedef struct {
  __global const ulong *nodes[KOKSMA_DIM];
  __global const ulong *weights[KOKSMA_DIM];
  __global const word *constants;
  ulong q[KOKSMA_DIM];
  uint r[KOKSMA_DIM], size[KOKSMA_DIM], base[KOKSMA_DIM], inverse[KOKSMA_DIM], turn[KOKSMA_DIM];
  ulong index;
  uint dim;
#if KOKSMA_HALTON_HAMMERSLEY
  rows rows;
#endif
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  __global const word *heads = table + table[1];
  __global const word *own = table + table[2] + (ulong)replicate * table[0];
  p->constants = table + table[4];
  p->index = first + lane;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_HALTON_BASES; ++d) {
    p->size[d] = (uint)heads[6 * d];
    p->nodes[d] = (__global const ulong *)(own + heads[6 * d + 1]);
    p->base[d] = (uint)heads[6 * d + 2];
    p->weights[d] = (__global const ulong *)(table + heads[6 * d + 3]);
    p->inverse[d] = (uint)heads[6 * d + 4];
    p->turn[d] = (uint)heads[6 * d + 5];
    const ulong q = p->index / p->size[d];
    p->q[d] = q * p->turn[d];
    p->r[d] = (uint)(p->index - q * p->size[d]);
  }
#if KOKSMA_HALTON_HAMMERSLEY
  rows_seek(&p->rows, table + table[3], first, seed, replicate, lane);
#endif
}

// floor(x y / 2^64), less at most 2: without the product of the low halves and two carries.
static inline words64 multiply_high(words64 x, ulong y) {
  const words64 high = x >> 32, low = x & 0xFFFFFFFFUL;
  const ulong upper = y >> 32, lower = y & 0xFFFFFFFFUL;
  return high * upper + (high * lower >> 32) + (low * upper >> 32);
}

// All ones in the lanes where a < b, a == b.
#if KOKSMA_LANES_PER_ITEM == 1
static inline words32 less_lanes(words32 a, words32 b) { return 0 - (words32)(a < b); }
static inline words32 equal_lanes(words32 a, words32 b) { return 0 - (words32)(a == b); }
#else
#define KOKSMA_AS_LANES KOKSMA_PASTE(as_uint, KOKSMA_LANES_PER_ITEM)
static inline words32 less_lanes(words32 a, words32 b) { return KOKSMA_AS_LANES(a < b); }
static inline words32 equal_lanes(words32 a, words32 b) { return KOKSMA_AS_LANES(a == b); }
#endif

// j_i for step i < 31: the top 27 bits of a hash times i + 1.
static inline words32 swap_of(words32 key0, words32 key1, uint i, __global const word *constants) {
  const words32 h = (key1 ^ (uint)constants[2 * i]) * (uint)constants[2 * i + 1] + key0;
  return (h >> 5) * (i + 1) >> 27;
}

// Where tau(a) of a shuffle of 1 ... b - 1 is: step i = 0 ... b - 2 of Fisher and Yates swaps places i and j_i <= i, so
// a - 1 goes to j_(a-1) and then wherever a later step takes it. Hash constants without structure: [i][2].
static inline words32 shuffled(words32 key0, words32 key1, uint a, uint base, __global const word *constants) {
  words32 place = swap_of(key0, key1, a - 1, constants);
  for (uint i = a; i + 1 < base; ++i) place ^= (place ^ i) & equal_lanes(place, swap_of(key0, key1, i, constants));
  return place + 1;
}

// Larger bases: a, by the replicate's shuffle of 1 ... b - 1, then three keyed bijections that do not commute: rotation mod
// b - 1, XOR where that stays below b - 1, a uniform factor mod b (Montgomery's product, whose 2^-16 is one more
// factor). The shuffle makes every order equally likely at a node, the factors make nodes independent.
static inline words32 multiplied(words32 key0, words32 key1, uint a, uint base, uint inverse) {
  const uint n = base - 1, digits = (1u << (32 - clz(n))) - 1;
  words32 x = a - 1 + ((key0 >> 16) * n >> 16);
  x = min(x, x - n);
  const words32 flip = key0 & digits;
  x ^= flip & less_lanes(x ^ flip, (words32)n);
  const words32 factor = 1 + (((key1 >> 16) * n + ((key1 & 0xFFFFu) * n >> 16)) >> 16);
  const words32 product = (x + 1) * factor;
  x = (product + (product * inverse & 0xFFFFu) * base) >> 16;
  return min(x, x - base);
}

// floor(b u / 2^64), b < 2^13.
static inline words64 first_digit(words64 u, uint base) {
  return ((u >> 32) * base + ((u & 0xFFFFFFFFUL) * base >> 32)) >> 32;
}

// Words of the lanes that come from places `value` and u of table nodes and go on with the digits of q > 0. `more`: their
// packed permutations, or the replicate's shuffle.
static inline words64 walk(const points *p, uint d, words64 value, words64 u, ulong q, __global const ulong *more) {
  const uint base = p->base[d];
  __global const ulong *weights = p->weights[d];
  const bool packed = base <= KOKSMA_HALTON_PACKED;
  words64 zero = u & KOKSMA_HALTON_DIGIT;
  for (bool first = true;; first = false) {
    const ulong rest = q / base;
    const uint a = (uint)(q - rest * base);
    q = rest;
    ++weights;
    if (a == 0) {
      value += zero * weights[0];
      u *= base;
    } else {
      words64 key = (u ^ u >> 32) * 0xD6E8FEB86659FD93UL;
      key ^= key >> 32;
      words64 tau;
      if (packed && first) {
        tau = (load_lanes(more) >> (4 * (a - 1)) & 15) + 1;
      } else {
        const words32 key0 = KOKSMA_TO_WORDS32(key), key1 = KOKSMA_TO_WORDS32(key >> 32);
        words32 hashed;
        if (packed)
          hashed = shuffled(key0, key1, a, base, p->constants);
        else
          hashed = multiplied(key0, key1, (uint)more[a], base, p->inverse[d]);
        tau = KOKSMA_TO_WORDS64(hashed);
      }
      tau += zero;
      value += min(tau, tau - base) * weights[0];
      // Another factor for every digit: no two children are the same function of the key.
      ulong digit = a * 0x9E3779B97F4A7C15UL;
      digit = (digit ^ digit >> 29) * 0xBF58476D1CE4E5B9UL;
      u = (key ^ digit >> 7) * (digit | 1);
      u ^= u >> 29;
    }
    if (q == 0) return value + multiply_high(u, weights[0]);
    zero = first_digit(u, base);
  }
}

static inline real points_next(points *p) {
  uint d = p->dim++;
#if KOKSMA_HALTON_HAMMERSLEY
  if (d == 0) return rows_coordinate(&p->rows);
  --d;
#endif
  if (d == 0) {
    const bits index = KOKSMA_TO_BITS(lane_numbers()) + (word)p->index;
    return unit_from_word(reverse_bits(owen_hash(index, (word)p->nodes[0][0], (word)p->nodes[0][1])));
  }
  const uint r = p->r[d], size = p->size[d], stride = size + KOKSMA_LANES - 1;
  const words64 value = load_lanes(p->nodes[d] + r), u = load_lanes(p->nodes[d] + stride + r);
  __global const ulong *more = p->nodes[d] + 2 * stride;
  if (p->base[d] <= KOKSMA_HALTON_PACKED) more += r;
  // Lanes beyond the wrap, if there are any, have q + 1.
  words64 w = value;
  const bool wraps = r + KOKSMA_LANES_PER_ITEM > size && p->turn[d] != 0;
  for (ulong q = p->q[d];; ++q) {
    words64 v;
    if (q == 0)
      v = value + multiply_high(u, p->weights[d][0]);
    else
      v = walk(p, d, value, u, q, more);
    if (q == p->q[d]) {
      w = v;
      if (!wraps) break;
    } else {
      w ^= (w ^ v) & KOKSMA_AS_WORDS64(KOKSMA_AS_SIGNED64((ulong)(size - r - 1) - KOKSMA_TO_WORDS64(lane_numbers())) >> 63);
      break;
    }
  }
#if KOKSMA_FP64
  return unit_from_word(w);
#else
  return unit_from_word(KOKSMA_TO_WORDS32(w >> 32));
#endif
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 1; d < KOKSMA_HALTON_BASES; ++d) {
    p->r[d] += KOKSMA_LANES;
    if (p->r[d] >= p->size[d]) {
      p->r[d] -= p->size[d];
      p->q[d] += p->turn[d];
    }
  }
#if KOKSMA_HALTON_HAMMERSLEY
  rows_step(&p->rows);
#endif
}
#else
typedef struct {
  __global const word *low[KOKSMA_DIM];  // T
  word now[KOKSMA_DIM], next[KOKSMA_DIM];  // the words of q and q + 1
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  word now_rest[KOKSMA_DIM], next_rest[KOKSMA_DIM];  // their remainders
#endif
  word upper[KOKSMA_DIM];  // P of the digits from level 3 on, of q + 1
  uint size[KOKSMA_DIM];   // B
  uint levels[KOKSMA_DIM];
  uint r[KOKSMA_DIM];      // of the first lane
  uint second[KOKSMA_DIM];  // level 2's digit of q + 1
  ulong index;
  uint dim;
#if KOKSMA_HALTON_HAMMERSLEY
  rows rows;
#endif
} points;

// floor((t 2^m + below) / size), t < size, below < 2^m.
static inline word radical_step(word t, word below, word size) {
#if !KOKSMA_FP64
  return (word)(((ulong)t << KOKSMA_MANTISSA_BITS | below) / size);
#elif KOKSMA_HALTON_BASES <= KOKSMA_HALTON_NARROW
  return (t << KOKSMA_MANTISSA_BITS | below) / size;
#else
  // 13 + 52 bits: in two parts.
  const word high = t << 40 | below >> 12, quotient = high / size;
  return quotient << 12 | ((high - quotient * size) << 12 | (below & 4095)) / size;
#endif
}

static inline __global const word *level_table(const points *p, uint d, uint level) {
  __global const word *table = p->low[d] + p->size[d] + KOKSMA_LANES - 1;
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  if (d >= KOKSMA_HALTON_NARROW) table += p->size[d] + KOKSMA_LANES - 1;
#endif
  return table + (level - 2) * p->size[d];
}

// Level 2's digit of q and P of its digits above.
static inline void split_digits(points *p, uint d, ulong q) {
  const uint size = p->size[d];
  uint digits[KOKSMA_HALTON_LEVELS];
  for (uint level = 2; level <= p->levels[d]; ++level) {
    const ulong rest = q / size;
    digits[level] = (uint)(q - rest * size);
    q = rest;
  }
  word above = p->low[d][-1];
  for (uint level = p->levels[d]; level > 2; --level)
    above = radical_step(level_table(p, d, level)[digits[level]], above, size);
  p->upper[d] = above;
  p->second[d] = digits[2];
}

// The word of the q whose digits are split, as `next`.
static inline void make_next(points *p, uint d) {
  const word size = p->size[d];
  const word inverse = radical_step(level_table(p, d, 2)[p->second[d]], p->upper[d], size);
  const word quotient = inverse / size, rest = inverse - quotient * size;
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  p->next[d] = quotient << KOKSMA_HALTON_SPARE;
  p->next_rest[d] = rest;
  if (d < KOKSMA_HALTON_NARROW) p->next[d] |= rest;
#else
  p->next[d] = quotient << KOKSMA_HALTON_SPARE | rest;
#endif
}

static inline void shift_next(points *p, uint d) {
  p->now[d] = p->next[d];
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  p->now_rest[d] = p->next_rest[d];
#endif
}

// q, that of the first lane, is now what was next.
static inline void advance(points *p, uint d) {
  shift_next(p, d);
  if (++p->second[d] == p->size[d]) split_digits(p, d, p->index / p->size[d] + 1);
  make_next(p, d);
}

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  __global const word *heads = table + table[1];
  __global const word *own = table + table[2] + (ulong)replicate * table[0];
  p->index = first + lane;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_HALTON_BASES; ++d) {
    const uint size = (uint)heads[4 * d];
    const ulong q = p->index / size;
    p->size[d] = size;
    p->low[d] = own + heads[4 * d + 1] + 1;
    p->levels[d] = (uint)heads[4 * d + 2];
    p->r[d] = (uint)(p->index - q * size);
    split_digits(p, d, q);
    make_next(p, d);
    advance(p, d);
  }
#if KOKSMA_HALTON_HAMMERSLEY
  rows_seek(&p->rows, table + table[3], first, seed, replicate, lane);
#endif
}

static inline real points_next(points *p) {
  uint d = p->dim++;
#if KOKSMA_HALTON_HAMMERSLEY
  if (d == 0) return rows_coordinate(&p->rows);
  --d;
#endif
  const uint r = p->r[d];
  // All ones in the lanes before the wrap.
  const bits lanes = KOKSMA_TO_BITS(lane_numbers());
  const bits before = KOKSMA_AS_BITS(KOKSMA_AS_SIGNED(lanes - (word)(p->size[d] - r)) >> (KOKSMA_SIGNED)(8 * sizeof(word) - 1));
  bits w = load_lanes(p->low[d] + r) + (word)p->next[d] + (before & (word)(p->now[d] - p->next[d]));
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  if (d >= KOKSMA_HALTON_NARROW) {
    const bits rest = load_lanes(p->low[d] + p->size[d] + KOKSMA_LANES - 1 + r) + (word)p->next_rest[d] +
                      (before & (word)(p->now_rest[d] - p->next_rest[d]));
    w += rest >> (word)KOKSMA_HALTON_REMAINDER_BITS << (word)KOKSMA_HALTON_SPARE;
  }
#endif
  return unit_from_word(w);
}

static inline void points_step(points *p) {
  p->index += KOKSMA_LANES;
  p->dim = 0;
  KOKSMA_UNROLL
  for (uint d = 0; d < KOKSMA_HALTON_BASES; ++d) {
    p->r[d] += KOKSMA_LANES;
    if (p->r[d] >= p->size[d]) {
      p->r[d] -= p->size[d];
      advance(p, d);
    }
  }
#if KOKSMA_HALTON_HAMMERSLEY
  rows_step(&p->rows);
#endif
}

#endif

static inline uint points_drawn(const points *p) { return p->dim; }
