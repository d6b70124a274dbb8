// permute: keyed bijections on [0, n), 1 <= n <= 2^32, computed lane by lane without a table; comes after philox.cl.
// A generalized Feistel network (Black & Rogaway, Ciphers with Arbitrary Finite Domains, CT-RSA 2002, section 6;
// Mitchell, Stokes, Frank & Holmes, Bandwidth-Optimal Random Shuffling for GPUs, ACM TOPC 2022): x = right a + left,
// left in [0,a), right in [0,b), and each half in turn is shifted modulo its own size by a hash of the other. a is the
// power of two near sqrt(n), b = ceil(n / a): the domain has fewer than a numbers too many, none where n is a power of
// two, and a lane that lands on one goes round again (cycle walking). As a is even, odd permutations occur too; with
// independent round functions every permutation of [0, n) is reached.
// Rounds: the joint distribution of two images comes nearer to uniform by a factor of min(a,b) per double round (exact
// computation of the chain of their difference); 2 + 16 / log2 a of them leave a total variation distance below 2^-15.
// Kensler's hash (2013) is one stage instead, known not to be uniform.
typedef struct {
  uint log2_a, b, last, rounds;
  uint log2_b;    // of a power of two
  uint is_power;  // n is one
} bijection;

static inline bijection bijection_on(ulong n) {
  bijection s;
  s.log2_a = (uint)(64 - clz(n - 1)) / 2;
  s.b = (uint)((n - 1) >> s.log2_a) + 1;
  s.last = (uint)(n - 1);
  s.is_power = (n & (n - 1)) == 0;
  s.log2_b = 31 - clz(s.b);
  s.rounds = 1;  // n <= 2: a random shift is all there is
  if (s.log2_a > 0) s.rounds = 2 + (15 + s.log2_a) / s.log2_a;
  return s;
}

// The upper bits of this are random functions of x: two thirds of Wellons' lowbias32 (hash-prospector, 2018). What it
// leaves out serves upper bits of x and lower ones of the result.
static inline words32 round_hash(words32 x) {
  x *= 0x7FEB352Du;
  x ^= x >> 15;
  return x * 0x846CA68Bu;
}

// lowbias32: every bit of the result depends on every bit of x.
static inline words32 avalanche(words32 x) {
  x = round_hash(x ^ x >> 16);
  return x ^ x >> 16;
}

// One pass through the network, on [0, a b).
static inline words32 permute_once(words32 x, bijection s, words32 key, words32 step) {
  const uint left_mask = (1u << s.log2_a) - 1, right_mask = (1u << s.log2_b) - 1;
  words32 left = x & left_mask, right = x >> s.log2_a;
  for (uint r = 0; r < s.rounds; ++r) {
    // A half of one value, log2 = 0, shifts by 32, which is 0 in OpenCL: the mask clears it.
    left = (left + (round_hash(right + key) >> (32 - s.log2_a))) & left_mask;
    key += step;
    const words32 hash = round_hash(left + key);
    key += step;
    if (s.is_power) {
      right = (right + (hash >> (32 - s.log2_b))) & right_mask;
    } else {
      words32 shift, unused;
      multiply_wide(hash, s.b, &shift, &unused);
      right += shift;
      right = min(right, right - s.b);  // the difference wraps where right < b
    }
  }
  return right << s.log2_a | left;
}

// The image of x under the bijection of a key and an odd step. x beyond the domain, a lane past the end of the set,
// counts as the last number.
static inline words32 permute(words32 x, bijection s, words32 key, words32 step) {
  x = permute_once(min(x, (words32)s.last), s, key, step);
  if (s.is_power) return x;
  for (;;) {
    // Less than a <= 2^16 above the last: its sign after the subtraction tells who has arrived.
    const words32 excess = x - min(x, (words32)s.last);
    if (all_lanes(KOKSMA_TO_BITS(excess) == (bits)(word)0)) return x;
    const words32 arrived = 0u - ((excess - 1u) >> 31);
    const words32 next = permute_once(x, s, key, step);
    x = next ^ ((x ^ next) & arrived);
  }
}
