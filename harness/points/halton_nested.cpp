// Nested uniform scrambling (Owen 1995) of radical inverses: the permutations of the first digits,
// drawn by shuffling; those of deeper digits are hashed in the kernel.
#include <algorithm>
#include <numeric>

#include "points/halton.hpp"

namespace koksma {
namespace {

using Wide = unsigned __int128;

constexpr std::uint32_t kNestedHeadWords = 6;
constexpr std::uint32_t kNestedPadding = 15;
constexpr std::uint32_t kPacked = 17;       // KOKSMA_HALTON_PACKED
constexpr std::uint64_t kDigitMask = 8191;  // KOKSMA_HALTON_DIGIT
constexpr std::uint64_t kSharedShuffle = std::uint64_t{1} << 40;
constexpr std::uint64_t kLow32 = 0xFFFFFFFFu;
constexpr std::uint32_t kNestedIndexBits =
    53;  // q + 1 of the last index below 2^52 has its digits too

// Digits whose permutations are drawn here: a function of the base alone, since the same node must
// have the same permutation in every set. Small bases get the larger tables, their digits are many.
BasePower nested_power(std::uint32_t base) {
  const std::uint32_t most = base < 23 ? 8192 : 1024;
  BasePower power{base, 1};
  while (power.size * base <= most) {
    power.size *= base;
    ++power.digits;
  }
  return power;
}

// What is tabulated: all that, or no more than the set's indices reach (but 16 lanes never wrap
// twice).
BasePower table_power(std::uint32_t base, std::uint64_t end_index) {
  const BasePower whole = nested_power(base);
  BasePower power{base, 1};
  while (power.digits < whole.digits && power.size < std::max<std::uint64_t>(end_index, 16)) {
    power.size *= base;
    ++power.digits;
  }
  return power;
}

// -1 / base mod 2^16 (Montgomery, Math. Comp. 44 (1985)), by Newton's iteration.
std::uint32_t montgomery_inverse(std::uint32_t base) {
  std::uint32_t inverse = base;
  for (int i = 0; i < 5; ++i) inverse *= 2 - base * inverse;
  return -inverse & 0xFFFFu;
}

// A node of the tree of digits: where its interval lies and what its points go on with.
struct Node {
  std::uint64_t t = 0;        // permuted digits so far, the first on top
  std::uint64_t uniform = 0;  // 2^64 times the place in its interval of the point that ends here
};

// The digits of one base in one replicate. Draws are numbered by node and digit.
struct Tree {
  const PointRequest& request;
  std::uint32_t base, replicate, dimension;

  RandomPair draw(std::uint64_t index) const {
    return random_pair(request.seed, index, replicate, RandomPurpose::nested_scramble, dimension);
  }
};

// The point that ends in a node goes on with zeros, so the first digit of `uniform` is the node's
// permutation of 0.
Node zero_child(const Node& node, std::uint32_t base) {
  const Wide product = Wide{node.uniform} * base;
  return {node.t * base + static_cast<std::uint64_t>(product >> 64),
          static_cast<std::uint64_t>(product)};
}

// Fisher and Yates' shuffle of 1 ... base - 1 by the draws from `first` on; entry 0 is 0. With the
// digit of zero added mod base it is the permutation of a node, every one equally likely.
std::vector<std::uint32_t> shuffle(const Tree& tree, std::uint64_t first) {
  std::vector<std::uint32_t> shuffled(tree.base);
  std::iota(shuffled.begin(), shuffled.end(), 0);
  for (std::uint32_t a = tree.base - 1; a > 0; --a) {
    const std::uint32_t b = 1 + uniform_below(a, [&](std::uint32_t attempt) {
                              return tree.draw((first + a) | std::uint64_t{attempt} << 48).first;
                            });
    std::swap(shuffled[a], shuffled[b]);
  }
  return shuffled;
}

// The nodes after `digits` digits, node r that of the index digits of r; `draws`: numbers used.
std::vector<Node> nodes_after(const Tree& tree, std::uint32_t digits, std::uint64_t& draws) {
  std::vector<Node> nodes{{0, tree.draw(0).first}};
  for (std::uint32_t k = 0; k < digits; ++k) {
    const std::size_t count = nodes.size();
    std::vector<Node> children(count * tree.base);
    for (std::size_t r = 0; r < count; ++r) {
      const std::uint64_t first = draws + r * tree.base;
      const std::vector<std::uint32_t> tau = shuffle(tree, first);
      children[r] = zero_child(nodes[r], tree.base);
      const auto zero = static_cast<std::uint32_t>(children[r].t - nodes[r].t * tree.base);
      for (std::uint32_t a = 1; a < tree.base; ++a)
        children[r + a * count] = {nodes[r].t * tree.base + (zero + tau[a]) % tree.base,
                                   tree.draw(first + a).second};
    }
    draws += count * tree.base;
    nodes.swap(children);
  }
  return nodes;
}

// `uniform` with its own first digit in the low 13 bits.
std::uint64_t with_first_digit(std::uint64_t uniform, std::uint32_t base) {
  const auto digit = [&](std::uint64_t u) {
    return static_cast<std::uint64_t>(Wide{u} * base >> 64);
  };
  uniform &= ~kDigitMask;
  // The digit's bits must not reach into the next digit's interval.
  if (digit(uniform | digit(uniform)) != digit(uniform)) uniform -= kDigitMask + 1;
  return uniform | digit(uniform);
}

// The kernel's multiply_high.
std::uint64_t multiply_high(std::uint64_t x, std::uint64_t y) {
  const std::uint64_t high = x >> 32, low = x & kLow32, upper = y >> 32, lower = y & kLow32;
  return high * upper + (high * lower >> 32) + (low * upper >> 32);
}

class Words {
 public:
  Words(std::vector<std::uint64_t>& words, bool fp64) : words_(words), fp64_(fp64) {}

  // 64 bits; in 32-bit tables as the device's memory holds them, at an even place.
  void push(std::uint64_t word) {
    words_.push_back(fp64_ ? word : word & kLow32);
    if (!fp64_) words_.push_back(word >> 32);
  }
  void align() {
    if (!fp64_ && words_.size() % 2 != 0) words_.push_back(0);
  }
  std::uint64_t size() const { return words_.size(); }

 private:
  std::vector<std::uint64_t>& words_;
  bool fp64_;
};

// floor(2^64 base^-n / size), n = 0, 1, ...
void push_weights(Words& out, std::uint32_t base, std::uint32_t size) {
  for (Wide power = size; power >> kNestedIndexBits == 0; power *= base)
    out.push(static_cast<std::uint64_t>((Wide{1} << 64) / power));
}

void push_nodes(Words& out, const Tree& tree) {
  const BasePower whole = nested_power(tree.base),
                  power = table_power(tree.base, tree.request.end_index);
  std::uint64_t draws = 1;
  std::vector<Node> nodes = nodes_after(tree, power.digits, draws);
  const auto word = [&](std::uint64_t t) {
    return static_cast<std::uint64_t>((Wide{t} << 64) / whole.size);
  };
  for (Node& node : nodes) {
    for (std::uint32_t k = power.digits; k < whole.digits; ++k) node = zero_child(node, tree.base);
    node = {word(node.t), with_first_digit(node.uniform, tree.base)};
    // A smaller table is for points that all end in it: their words, to the bit those of a larger.
    if (power.size < whole.size) node = {node.t + multiply_high(node.uniform, word(1)), 0};
  }
  const std::uint32_t padded = power.size + kNestedPadding;
  for (std::uint32_t i = 0; i < padded; ++i) out.push(nodes[i % power.size].t);
  for (std::uint32_t i = 0; i < padded; ++i) out.push(nodes[i % power.size].uniform);
  if (power.size < whole.size) return;
  std::vector<std::uint64_t> packed(power.size, 0);
  for (std::uint32_t r = 0; tree.base <= kPacked && r < power.size; ++r) {
    const std::vector<std::uint32_t> tau = shuffle(tree, draws + std::uint64_t{r} * tree.base);
    for (std::uint32_t a = 1; a < tree.base; ++a)
      packed[r] |= std::uint64_t{tau[a] - 1} << (4 * (a - 1));
  }
  for (std::uint32_t i = 0; tree.base <= kPacked && i < padded; ++i)
    out.push(packed[i % power.size]);
  for (const std::uint32_t a : shuffle(tree, kSharedShuffle)) out.push(a);
}

// Of the kernel's shuffles, from the generator splitmix64 (Steele, Lea and Flood, OOPSLA 2014).
void push_constants(std::vector<std::uint64_t>& words) {
  std::uint64_t state = 0;
  for (std::uint32_t i = 0; i < kPacked; ++i) {
    std::uint64_t z = state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    z ^= z >> 31;
    words.insert(words.end(), {z >> 32, (z | 1) & kLow32});
  }
}

// Keys of owen_hash (parts/owen.cl), as digital.cpp draws them.
void push_keys(Words& out, const PointRequest& request, std::uint32_t r, std::uint32_t dimension) {
  const RandomPair key = random_pair(request.seed, 0, r, RandomPurpose::nested_scramble, dimension);
  out.push(key.first);
  out.push(key.second | 1);
}

}  // namespace

void append_nested_tables(std::vector<std::uint64_t>& words, const PointRequest& request,
                          const std::vector<std::uint32_t>& bases) {
  Words out(words, request.fp64);
  const auto place = [&](std::size_t j, std::size_t field) -> std::uint64_t& {
    return words[words[1] + j * kNestedHeadWords + field];
  };
  words[1] = words.size();
  words.resize(words.size() + bases.size() * kNestedHeadWords);
  words[4] = words.size();
  push_constants(words);
  out.align();
  for (std::size_t j = 0; j < bases.size(); ++j) {
    const std::uint32_t size = table_power(bases[j], request.end_index).size;
    const std::uint64_t turn = size == nested_power(bases[j]).size ? 1 : 0;
    const std::uint64_t fields[] = {size, 0, bases[j], out.size(), montgomery_inverse(bases[j]),
                                    turn};
    for (std::size_t f = 0; f < std::size(fields); ++f) place(j, f) = fields[f];
    push_weights(out, bases[j], size);
  }
  words[2] = out.size();
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    const std::uint64_t start = out.size();
    for (std::uint32_t j = 0; j < bases.size(); ++j) {
      place(j, 1) = out.size() - start;
      if (bases[j] == 2)
        push_keys(out, request, r, j);
      else
        push_nodes(out, {request, bases[j], r, j});
    }
    words[0] = out.size() - start;
  }
}

}  // namespace koksma
