// Nested uniform scrambling (Owen 1995) of radical inverses: the permutations of the first digits,
// drawn by shuffling; those of deeper digits are hashed in the kernel.
#include <algorithm>
#include <numeric>

#include "points/halton.hpp"

namespace koksma {
namespace {

using Wide = unsigned __int128;

constexpr std::uint32_t kHeadWords = 6;
constexpr std::uint32_t kPadding = 15;
constexpr std::uint32_t kIndexBits = 53;  // q + 1 of the last index below 2^52 has its digits too

// Digits whose permutations are drawn here: a function of the base alone, since the same node must
// have the same permutation in every set. Small bases get the larger tables, their digits are many.
BasePower nested_power(std::uint32_t base, std::uint64_t end_index) {
  const std::uint32_t most = base < 23 ? 8192 : 1024;
  BasePower power{base, 1};
  // Fewer where no index of the set has them: the rest of the nodes is never visited. 16 lanes must
  // not wrap twice.
  while (power.size * base <= most && power.size < std::max<std::uint64_t>(end_index, 16)) {
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

// The nodes after `power.digits` digits, node r that of the index digits of r. The point that ends
// in a node goes on with zeros, so that the first digit of `uniform` is the node's permutation of
// 0; the other digits a follow by a shuffle of 1 ... base - 1 added to it. Every permutation is
// equally likely, to 2^-64 base^(zeros before).
std::vector<Node> nested_nodes(const PointRequest& request, std::uint32_t base,
                               const BasePower& power, std::uint32_t replicate,
                               std::uint32_t dimension) {
  const auto draw = [&](std::uint64_t index) {
    return random_pair(request.seed, index, replicate, RandomPurpose::nested_scramble, dimension);
  };
  std::vector<Node> nodes{{0, draw(0).first}};
  std::vector<std::uint32_t> shuffled(base);
  std::uint64_t draws = 0;  // of the levels above
  for (std::uint32_t k = 0; k < power.digits; ++k) {
    const std::size_t count = nodes.size();
    std::vector<Node> children(count * base);
    for (std::size_t r = 0; r < count; ++r) {
      const Wide product = Wide{nodes[r].uniform} * base;
      const auto zero = static_cast<std::uint32_t>(product >> 64);
      children[r] = {nodes[r].t * base + zero, static_cast<std::uint64_t>(product)};
      std::iota(shuffled.begin(), shuffled.end(), 0);
      for (std::uint32_t a = base - 1; a > 0; --a) {
        const std::uint64_t index = draws + r * base + a;
        const std::uint32_t b = 1 + uniform_below(a, [&](std::uint32_t attempt) {
          return draw(index | std::uint64_t{attempt} << 48).first;
        });
        std::swap(shuffled[a], shuffled[b]);
        children[r + a * count] = {nodes[r].t * base + (zero + shuffled[a]) % base,
                                   draw(index).second};
      }
    }
    draws += count * base;
    nodes.swap(children);
  }
  return nodes;
}

class Words {
 public:
  Words(std::vector<std::uint64_t>& words, bool fp64) : words_(words), fp64_(fp64) {}

  // 64 bits; in 32-bit tables as the device's memory holds them, at an even place.
  void push(std::uint64_t word) {
    words_.push_back(fp64_ ? word : word & 0xFFFFFFFFu);
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
  for (Wide power = size; power >> kIndexBits == 0; power *= base)
    out.push(static_cast<std::uint64_t>((Wide{1} << 64) / power));
}

void push_nodes(Words& out, const PointRequest& request, std::uint32_t base, std::uint32_t r,
                std::uint32_t dimension) {
  const BasePower power = nested_power(base, request.end_index);
  const std::vector<Node> nodes = nested_nodes(request, base, power, r, dimension);
  for (std::uint32_t i = 0; i < power.size + kPadding; ++i)
    out.push(static_cast<std::uint64_t>((Wide{nodes[i % power.size].t} << 64) / power.size));
  for (std::uint32_t i = 0; i < power.size + kPadding; ++i)
    out.push(nodes[i % power.size].uniform);
}

// Keys of owen_hash (parts/owen.cl), as digital.cpp draws them.
void push_keys(Words& out, const PointRequest& request, std::uint32_t r, std::uint32_t dimension) {
  const RandomPair key =
      random_pair(request.seed, 0, r, RandomPurpose::nested_scramble, dimension);
  out.push(key.first);
  out.push(key.second | 1);
}

}  // namespace

void append_nested_tables(std::vector<std::uint64_t>& words, const PointRequest& request,
                          const std::vector<std::uint32_t>& bases) {
  Words out(words, request.fp64);
  const auto place = [&](std::size_t j, std::size_t field) -> std::uint64_t& {
    return words[words[1] + j * kHeadWords + field];
  };
  words[1] = words.size();
  words.resize(words.size() + bases.size() * kHeadWords);
  out.align();
  for (std::size_t j = 0; j < bases.size(); ++j) {
    const std::uint32_t size = nested_power(bases[j], request.end_index).size;
    const std::uint64_t fields[] = {size, 0, bases[j], out.size(), montgomery_inverse(bases[j])};
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
        push_nodes(out, request, bases[j], r, j);
    }
    words[0] = out.size() - start;
  }
}

}  // namespace koksma
