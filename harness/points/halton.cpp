// Tables of the halton family (kernels/points/halton.cl): radical inverses whose digits are
// permuted by position, and the rows of Hammersley sets.
#include "points/halton.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace koksma {
namespace {

using Wide = unsigned __int128;

constexpr std::uint32_t kHaltonHeader = 8;
constexpr std::uint32_t kHeadWords = 4;
constexpr std::uint32_t kPadding = 15;        // the lanes beyond a wrap
constexpr std::uint32_t kRemainderBits = 14;  // KOKSMA_HALTON_REMAINDER_BITS
constexpr std::uint32_t kFractionBits = 52;
constexpr std::uint32_t kIndexBits = 52;

std::uint32_t mantissa_bits(bool fp64) { return fp64 ? 52 : 23; }
std::uint32_t spare_bits(bool fp64) { return fp64 ? 12 : 9; }

// The smallest power >= 256, in many dimensions >= 64, so that the tables stay in the cache; less
// where its remainders have no room beside the mantissa.
BasePower table_power(std::uint32_t base, std::uint32_t bases, bool fp64) {
  const std::uint32_t wanted = bases < 32 ? 256 : 64, most = 1u << spare_bits(fp64);
  BasePower power{base, 1};
  while (power.size < wanted && power.size * base <= most) {
    power.size *= base;
    ++power.digits;
  }
  return power;
}

// At least 2: the kernel takes the first lane's q and q + 1 apart.
std::uint32_t levels_of(std::uint32_t size, std::uint64_t end_index) {
  std::uint32_t levels = 2;
  for (Wide reached = Wide{size} * size; reached < end_index; reached *= size) ++levels;
  return levels;
}

// Digits that are permuted: ceil(52 / log2 base), and what fills the last level of any cut into
// tables. It must not depend on the cut, where the uniform tail begins.
std::uint32_t permuted_positions(std::uint32_t base) {
  std::uint32_t digits = 0;
  for (Wide reached = 1; reached < Wide{1} << kIndexBits; reached *= base) ++digits;
  return digits + (base < 23 ? 8 : base < 257 ? 1 : 0);
}

// What is done to the digits of one base in one replicate: digit a of position k becomes
// permutations[k][a]; beyond the last position comes `tail`, in 2^-52.
struct Digits {
  std::uint32_t base = 2;
  std::vector<std::vector<std::uint32_t>> permutations;
  std::uint64_t tail = 0;
};

// Fisher and Yates' shuffle, one per position.
Digits permuted_digits(const PointRequest& request, std::uint32_t base, std::uint32_t replicate,
                       std::uint32_t dimension) {
  const auto draw = [&](std::uint64_t index) {
    return random_pair(request.seed, index, replicate, RandomPurpose::digit_permutation, dimension)
        .first;
  };
  const std::uint32_t positions = permuted_positions(base);
  Digits digits{base, {}, draw(std::uint64_t{positions} << 32) >> (64 - kFractionBits)};
  for (std::uint32_t k = 0; k < positions; ++k) {
    std::vector<std::uint32_t> permutation(base);
    std::iota(permutation.begin(), permutation.end(), 0);
    for (std::uint32_t a = base - 1; a > 0; --a) {
      const std::uint32_t b = uniform_below(a + 1, [&](std::uint32_t attempt) {
        return draw(std::uint64_t{attempt} << 48 | std::uint64_t{k} << 32 | a);
      });
      std::swap(permutation[a], permutation[b]);
    }
    digits.permutations.push_back(std::move(permutation));
  }
  return digits;
}

// Digit a of position k becomes (a + shift k) mod base; `positions` of them.
Digits shifted_digits(std::uint32_t base, std::uint32_t shift, std::uint32_t positions) {
  Digits digits{base, {}, 0};
  for (std::uint32_t k = 0; k < positions; ++k) {
    std::vector<std::uint32_t> permutation(base);
    for (std::uint32_t a = 0; a < base; ++a) permutation[a] = (a + shift * k) % base;
    digits.permutations.push_back(std::move(permutation));
  }
  return digits;
}

// floor(2^52 x), x the fraction that zeros from `position` on become.
std::uint64_t zeros_from(const Digits& digits, std::uint32_t position) {
  Wide below = digits.tail;
  for (std::size_t k = digits.permutations.size(); k-- > position;)
    below = ((Wide{digits.permutations[k][0]} << kFractionBits) + below) / digits.base;
  return static_cast<std::uint64_t>(below);
}

// t(r) for the digits of positions first, first + 1, ... of r < size.
std::vector<std::uint64_t> reversed_integers(const Digits& digits, const BasePower& power,
                                             std::uint32_t first) {
  std::vector<std::uint64_t> t{0};
  std::vector<std::uint64_t> grown;
  for (std::uint32_t k = 0; k < power.digits; ++k) {
    grown.resize(t.size() * digits.base);
    for (std::uint32_t a = 0; a < digits.base; ++a)
      for (std::size_t r = 0; r < t.size(); ++r)
        grown[a * t.size() + r] = t[r] * digits.base + digits.permutations[first + k][a];
    t.swap(grown);
  }
  return t;
}

// The kernel's T (and remainders), then the integers of the levels above.
void append_digit_tables(std::vector<std::uint64_t>& words, const Digits& digits,
                         const BasePower& power, std::uint32_t levels, bool fp64) {
  const std::uint32_t m = mantissa_bits(fp64), s = spare_bits(fp64), size = power.size;
  words.push_back(zeros_from(digits, levels * power.digits) >> (kFractionBits - m));
  const std::vector<std::uint64_t> t = reversed_integers(digits, power, 0);
  const bool narrow = size <= 1u << s;
  for (std::uint32_t r = 0; r < size + kPadding; ++r) {
    const Wide scaled = Wide{t[r % size]} << m;
    const auto rest = static_cast<std::uint64_t>(scaled % size);
    words.push_back(static_cast<std::uint64_t>(scaled / size) << s |
                    (narrow ? (1u << s) - size + rest : 0));
  }
  for (std::uint32_t r = 0; !narrow && r < size + kPadding; ++r)
    words.push_back((1u << kRemainderBits) - size +
                    static_cast<std::uint64_t>((Wide{t[r % size]} << m) % size));
  for (std::uint32_t level = 1; level < levels; ++level) {
    const auto above = reversed_integers(digits, power, level * power.digits);
    words.insert(words.end(), above.begin(), above.end());
  }
}

void append_replicates(std::vector<std::uint64_t>& words, const PointRequest& request,
                       const std::vector<std::uint32_t>& bases) {
  const std::string kind = request.options.at("digits");
  const bool permuted = kind == "permuted";
  const std::size_t heads = words.size();
  words.resize(heads + bases.size() * kHeadWords);
  words[1] = heads;
  words[2] = words.size();
  for (std::uint32_t r = 0; r < (permuted ? request.replicates : 1); ++r) {
    const std::size_t start = words.size();
    for (std::uint32_t j = 0; j < bases.size(); ++j) {
      const BasePower power =
          table_power(bases[j], static_cast<std::uint32_t>(bases.size()), request.fp64);
      const std::uint32_t levels = levels_of(power.size, request.end_index);
      const std::uint64_t head[] = {power.size, words.size() - start, levels};
      std::copy(std::begin(head), std::end(head),
                words.begin() + static_cast<std::ptrdiff_t>(heads + std::size_t{j} * kHeadWords));
      // Folded zeros go on for ever: 80 digits more are below 2^-52 by any margin.
      const Digits digits =
          permuted ? permuted_digits(request, bases[j], r, j)
                   : shifted_digits(bases[j], kind == "folded" ? 1 : 0,
                                    levels * power.digits + (kind == "folded" ? 80 : 0));
      append_digit_tables(words, digits, power, levels, request.fp64);
    }
    if (permuted) words[0] = words.size() - start;
  }
}

// floor(i 2^64 / N) and what remains for i = 2^k, and for the step of 16 indices.
void append_rows(std::vector<std::uint64_t>& words, const PointRequest& request) {
  const std::uint64_t n = request.end_index;
  const auto push = [&](std::uint64_t word) {
    words.push_back(request.fp64 ? word : word & 0xFFFFFFFFu);
    if (!request.fp64) words.push_back(word >> 32);
  };
  // 2^64 i mod 2^64 N, so that 128 bits hold it: whole turns never show.
  const auto push_quotient = [&](std::uint64_t i) {
    const Wide scaled = Wide{i % n} << 64;
    push(static_cast<std::uint64_t>(scaled / n));
    push(static_cast<std::uint64_t>(scaled % n));
  };
  words[3] = words.size();
  push(n);
  push_quotient(16);
  push(static_cast<std::uint64_t>((Wide{1} << 64) / n));
  push(std::has_single_bit(n) ? 64 - static_cast<std::uint64_t>(std::countr_zero(n)) : 0);
  for (std::uint32_t k = 0; k < kIndexBits; ++k) push_quotient(std::uint64_t{1} << k);
}

}  // namespace

std::vector<std::uint32_t> first_primes(std::uint32_t count) {
  std::vector<std::uint32_t> primes;
  for (std::uint32_t candidate = 2; primes.size() < count; ++candidate)
    if (std::none_of(primes.begin(), primes.end(),
                     [&](std::uint32_t p) { return candidate % p == 0; }))
      primes.push_back(candidate);
  return primes;
}

PointTable build_halton(const PointRequest& request) {
  const bool rows = request.options.at("rows");
  const std::uint32_t first = rows ? 1 : 0;
  const auto bases = in_draw_order(request, first_primes(request.dim - first), first);
  PointTable table;
  table.words.resize(kHaltonHeader);
  if (rows) append_rows(table.words, request);
  if (request.options.at("digits") == "owen")
    append_nested_tables(table.words, request, bases);
  else
    append_replicates(table.words, request, bases);
  return table;
}

}  // namespace koksma
