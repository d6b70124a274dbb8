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
//   [B + 15], their u [B + 15], then up to base 17 their tau [B + 15], tau(a) - 1 in bits 4 (a - 1) on; then the
//   replicate's shuffle of 1 ... b - 1 [b]. All but the heads are 64 bits, low half first.
// Bases up to here have a table of the nodes' permutations, and up to here shuffle by hashes at deeper nodes too.
#define KOKSMA_HALTON_PACKED 17
#define KOKSMA_HALTON_SHUFFLED 7
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

// floor(b u / 2^64), b < 2^13.
static inline words64 first_digit(words64 u, uint base) {
  return ((u >> 32) * base + ((u & 0xFFFFFFFFUL) * base >> 32)) >> 32;
}

// Words of the lanes that come from places `value` and u of table nodes and go on with the digits of q > 0.
static inline words64 walk(const points *p, uint d, words64 value, words64 u, ulong q) {
  const uint base = p->base[d];
  __global const ulong *weights = p->weights[d];
  const bool packed = base <= KOKSMA_HALTON_PACKED;
  const uint stride = p->size[d] + KOKSMA_LANES - 1;
  __global const ulong *shuffle = p->nodes[d] + 2 * stride;
  __global const ulong *orders = shuffle + p->r[d];
  if (packed) shuffle += stride;
  words64 zero = u & KOKSMA_HALTON_DIGIT;
  for (bool first = true;; first = false) {
    // Most walks end with this digit, without a division.
    uint a = (uint)q;
    if (q < base) {
      q = 0;
    } else {
      const ulong rest = q / base;
      a = (uint)(q - rest * base);
      q = rest;
    }
    ++weights;
    if (a == 0) {
      value += zero * weights[0];
      u *= base;
    } else {
      words64 key = (u ^ u >> 32) * 0xD6E8FEB86659FD93UL;
      key ^= key >> 32;
      words64 tau;
      if (packed && first) {
        tau = (load_lanes(orders) >> (4 * (a - 1)) & 15) + 1;
      } else {
        const words32 key0 = KOKSMA_TO_WORDS32(key), key1 = KOKSMA_TO_WORDS32(key >> 32);
        words32 hashed;
        if (base <= KOKSMA_HALTON_SHUFFLED)
          hashed = shuffled(key0, key1, a, base, p->constants);
        else
          hashed = multiplied(key0, key1, (uint)shuffle[a], base, p->inverse[d]);
        tau = KOKSMA_TO_WORDS64(hashed);
      }
      tau += zero;
      value += min(tau, tau - base) * weights[0];
      // Another factor for every digit: no two children are the same function of the key.
      ulong digit = a * 0x9E3779B97F4A7C15UL;
      digit = (digit ^ digit >> 29) * 0xBF58476D1CE4E5B9UL;
      u = (key ^ digit >> 7) * (digit | 1);
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
  // Lanes beyond the wrap, if there are any, have q + 1.
  words64 w = value;
  const bool wraps = r + KOKSMA_LANES_PER_ITEM > size && p->turn[d] != 0;
  for (ulong q = p->q[d];; ++q) {
    words64 v;
    if (q == 0)
      v = value + multiply_high(u, p->weights[d][0]);
    else
      v = walk(p, d, value, u, q);
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
  __global const word *at[KOKSMA_DIM];   // T at r, that of the first lane
  word next[KOKSMA_DIM], now_less_next[KOKSMA_DIM];  // from the words of q and q + 1
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  word next_rest[KOKSMA_DIM], now_less_next_rest[KOKSMA_DIM];  // and their remainders
#endif
  word upper[KOKSMA_DIM];  // P of the digits from level 3 on, of q + 1
  uint size[KOKSMA_DIM];   // B
  uint levels[KOKSMA_DIM];
  word left[KOKSMA_DIM];   // B - r
  uint second[KOKSMA_DIM];  // level 2's digit of q + 1
  ulong index;
  uint dim;
#if KOKSMA_HALTON_HAMMERSLEY
  rows rows;
#endif
} points;

// floor((t 2^m + below) / size), t < size, below < 2^m. In one word where size <= 2^s.
static inline word radical_step(word t, word below, word size) {
#if KOKSMA_HALTON_BASES <= KOKSMA_HALTON_NARROW
  return (t << KOKSMA_MANTISSA_BITS | below) / size;
#elif !KOKSMA_FP64
  return (word)(((ulong)t << KOKSMA_MANTISSA_BITS | below) / size);
#else
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

// `next` becomes the word of the q whose digits are split.
static inline void make_next(points *p, uint d) {
  const word size = p->size[d];
  const word inverse = radical_step(level_table(p, d, 2)[p->second[d]], p->upper[d], size);
  const word quotient = inverse / size, rest = inverse - quotient * size;
  word next = quotient << KOKSMA_HALTON_SPARE;
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  p->now_less_next_rest[d] = p->next_rest[d] - rest;
  p->next_rest[d] = rest;
  if (d < KOKSMA_HALTON_NARROW) next |= rest;
#else
  next |= rest;
#endif
  p->now_less_next[d] = p->next[d] - next;
  p->next[d] = next;
}

// q, that of the first lane, is now what was next.
static inline void advance(points *p, uint d) {
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
    p->left[d] = (word)(size - (p->index - q * size));
    p->at[d] = p->low[d] + (size - p->left[d]);
    p->next[d] = 0;
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
    p->next_rest[d] = 0;
#endif
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
  // All ones in the lanes before the wrap.
#if KOKSMA_LANES_PER_ITEM == 1
  const bits before = 0 - (word)(p->left[d] > 0);
#else
  const bits before = KOKSMA_AS_BITS(KOKSMA_TO_BITS(lane_numbers()) < p->left[d]);
#endif
  bits w = load_lanes(p->at[d]) + p->next[d] + (before & p->now_less_next[d]);
#if KOKSMA_HALTON_BASES > KOKSMA_HALTON_NARROW
  if (d >= KOKSMA_HALTON_NARROW) {
    const bits rest =
        load_lanes(p->at[d] + p->size[d] + KOKSMA_LANES - 1) + p->next_rest[d] + (before & p->now_less_next_rest[d]);
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
    p->at[d] += KOKSMA_LANES;
    if (p->left[d] > KOKSMA_LANES) {
      p->left[d] -= KOKSMA_LANES;
    } else {
      p->left[d] += p->size[d] - KOKSMA_LANES;
      p->at[d] -= p->size[d];
      advance(p, d);
    }
  }
#if KOKSMA_HALTON_HAMMERSLEY
  rows_step(&p->rows);
#endif
}

#endif

static inline uint points_drawn(const points *p) { return p->dim; }
