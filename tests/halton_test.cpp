// Radical inverses: exact where they are deterministic, one point per interval of every prime base
// under every randomization, Hammersley sets one point per row.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "tests/halton_support.hpp"

using namespace koksma;
using namespace koksma::test;

namespace {

std::vector<Sampler> with_property(const char* property) {
  std::vector<Sampler> found;
  for (const Sampler& s : test::catalog().samplers)
    if (test::has_property(s, property)) found.push_back(s);
  REQUIRE(found.size() >= 2);
  return found;
}

// floor(2^bits phi(i)), folded with the tail of its infinite expansion: 200 digits, 12 at a time or
// fewer, by long division from the last.
std::uint64_t inverse(std::uint64_t i, std::uint32_t base, bool folded, int bits) {
  std::vector<std::uint32_t> digits;
  for (std::uint32_t k = 0; k < 200; ++k, i /= base)
    digits.push_back(static_cast<std::uint32_t>((i % base + (folded ? k : 0)) % base));
  // 100 fractional bits leave no doubt about the first 52.
  Wide x = 0;
  for (std::size_t k = digits.size(); k-- > 0;) x = ((Wide{digits[k]} << 100) + x) / base;
  return static_cast<std::uint64_t>(x >> (100 - bits));
}

}  // namespace

TEST_CASE(
    "deterministic radical inverses are the exact rationals, rounded down, also beyond 2^40 and "
    "where 16 lanes straddle powers of a base",
    "[device]") {
  for (const Sampler& s : with_property("radical-inverse")) {
    const bool folded = s.options["digits"] == "folded";
    for (const Precision precision : test::precisions(s)) {
      const int bits = bits_of(precision);
      std::vector<std::uint64_t> starts{0, 720, (1U << 23) - 600};
      if (bits == 52)
        starts.insert(starts.end(), {(1ULL << 32) - 300, (1ULL << 40) + 7, (1ULL << 52) - 600});
      for (const std::uint64_t start : starts) {
        const auto x = points(
            {.sampler = s.name, .dim = kDim, .precision = precision, .start = start, .count = 600});
        for (std::uint64_t i = 0; i < 600; ++i) {
          for (std::uint32_t d = rows(s); d < kDim; ++d) {
            INFO(s.name << " index " << start + i << " dimension " << d << " of " << bits
                        << " bits");
            REQUIRE(std::ldexp(x[i * kDim + d], bits) ==
                    static_cast<double>(inverse(start + i, base_of(s, d), folded, bits)));
          }
        }
      }
    }
  }
}

TEST_CASE("bases beyond the table words' spare bits are exact too, to the last of 1024 dimensions",
          "[device]") {
  // The 98th prime exceeds 2^9, the 565th 2^12.
  for (const auto& [precision, lanes] : std::vector<std::pair<Precision, std::uint32_t>>{
           {Precision::fp32, 16}, {Precision::fp64, 16}, {Precision::fp32, 1}}) {
    const std::uint32_t dim = 1024;
    const auto bases = first_primes(dim);
    const int bits = bits_of(precision);
    for (const std::uint64_t start : {8150U, (1U << 22) + 5}) {
      const auto x = points({.sampler = "halton",
                             .dim = dim,
                             .precision = precision,
                             .start = start,
                             .count = 40,
                             .lanes_per_item = lanes});
      for (std::uint64_t i = 0; i < 40; ++i)
        for (std::uint32_t d = 0; d < dim; d += d < 90 ? 30 : 1) {
          INFO("index " << start + i << " base " << bases[d] << " of " << bits << " bits");
          REQUIRE(std::ldexp(x[i * dim + d], bits) ==
                  static_cast<double>(inverse(start + i, bases[d], false, bits)));
        }
    }
  }
}

TEST_CASE(
    "the first b^k points have one point in each interval of length b^-k of a dimension of base b, "
    "whatever the randomization, and one in each box of two bases",
    "[device]") {
  const std::uint64_t n = 20000;
  for (const Sampler& s : with_property("prime-strata")) {
    for (const std::uint32_t r : test::some_replicates(s)) {
      const auto x = points({.sampler = s.name, .dim = kDim, .count = n, .replicate = r, .n = n});
      for (std::uint32_t d = rows(s); d < kDim; ++d) {
        const std::uint64_t base = base_of(s, d);
        for (std::uint64_t power = base; power <= n; power *= base) {
          std::set<std::uint64_t> seen;
          for (std::uint64_t i = 0; i < power; ++i)
            seen.insert(interval_of(x[i * kDim + d], power, s.centred));
          INFO(s.name << " replicate " << r << " base " << base << " points " << power);
          REQUIRE((seen.size() == power && *seen.rbegin() < power));
        }
      }
      const std::uint32_t j = rows(s);  // bases 2 and 3; then 3 and 5
      for (const auto& [d, first, second] : std::vector<std::array<std::uint64_t, 3>>{
               {j, 16, 27}, {j, 64, 81}, {j, 2, 6561}, {j + 1, 81, 125}, {j + 1, 3, 3125}}) {
        std::set<std::pair<std::uint64_t, std::uint64_t>> boxes;
        for (std::uint64_t i = 0; i < first * second; ++i)
          boxes.emplace(interval_of(x[i * kDim + d], first, s.centred),
                        interval_of(x[i * kDim + d + 1], second, s.centred));
        INFO(s.name << " replicate " << r << " boxes " << first << " x " << second);
        REQUIRE(boxes.size() == first * second);
      }
    }
  }
}

TEST_CASE("point i of a Hammersley set lies in row i of N, for N of any form", "[device]") {
  // To the grid: the cell of the coordinate meets [i/N, (i+1)/N).
  for (const Sampler& s : with_property("first-coordinate-rows")) {
    for (const Precision precision : test::precisions(s)) {
      const int bits = bits_of(precision);
      for (const std::uint64_t n : {1U, 2U, 7U, 16U, 1000U, 4096U, 12345U, 19683U, 65537U}) {
        for (const std::uint32_t r : test::some_replicates(s)) {
          const auto x = points({.sampler = s.name,
                                 .dim = kDim,
                                 .precision = precision,
                                 .count = n,
                                 .replicate = r,
                                 .n = n});
          std::set<double> distinct;
          for (std::uint64_t i = 0; i < n; ++i) {
            const Wide cell = cell_of(x[i * kDim], bits);
            distinct.insert(x[i * kDim]);
            INFO(s.name << " " << precision_name(precision) << " N " << n << " point " << i);
            if (!s.replicable) REQUIRE(cell == (Wide{i} << bits) / n);
            REQUIRE(cell * n < Wide{i + 1} << bits);
            REQUIRE((cell + 1) * n > Wide{i} << bits);
          }
          REQUIRE((bits == 23 || distinct.size() == n));
        }
      }
    }
  }
}

TEST_CASE("later coordinates of a Hammersley set are the Halton sequence of the same name",
          "[device]") {
  for (const Sampler& s : with_property("first-coordinate-rows")) {
    const std::string halton = "halton" + s.name.substr(std::string("hammersley").size());
    const auto set =
        points({.sampler = s.name, .dim = kDim, .count = 3000, .replicate = 1, .n = 3000});
    const auto sequence = points({.sampler = halton, .dim = kDim, .count = 3000, .replicate = 1});
    for (std::size_t i = 0; i < 3000; ++i)
      for (std::size_t d = 1; d < kDim; ++d) {
        INFO(s.name << " point " << i << " dimension " << d);
        REQUIRE(set[i * kDim + d] == sequence[i * kDim + d - 1]);
      }
  }
}

TEST_CASE(
    "radical inverses: random access equals replay, fp32 draws fp64's points at 23 bits, and every "
    "width draws the same, below and beyond 2^32",
    "[device]") {
  for (const Sampler& s : with_property("prime-strata")) {
    const std::uint32_t r = s.replicable ? 2 : 0;
    for (const std::uint64_t start :
         {0ULL, (1ULL << 23) - 8208, (1ULL << 32) - 4096, (1ULL << 45) + 16}) {
      if (start > 1U << 23 && !s.replicable) continue;  // fp32 does not resolve them
      const std::uint64_t n = start + 8192 + (s.extensible ? 0 : 5);
      test::PointsSpec spec{.sampler = s.name,
                            .dim = kDim,
                            .start = start,
                            .count = 8192,
                            .replicate = r,
                            .log2_block = 13,
                            .n = n};
      const auto fine = points(spec);
      spec.log2_block = 4;
      INFO(s.name << " from " << start);
      REQUIRE(fine == points(spec));
      spec.precision = Precision::fp32;
      const auto coarse = points(spec);
      for (std::size_t i = 0; i < fine.size(); ++i)
        if (cell_of(fine[i], 23) != cell_of(coarse[i], 23))
          FAIL("coordinate " << i % kDim << " of point " << i / kDim);
      if (s.name == "halton" || s.name == "halton-owen" || s.name == "hammersley-permuted") {
        for (const std::uint32_t lanes : {1U, 4U, 8U}) {
          spec.lanes_per_item = lanes;
          REQUIRE(coarse == points(spec));
        }
      }
    }
  }
}

TEST_CASE(
    "permuted digits: a permutation for every position, which acts on all points alike, also at "
    "leading zeros",
    "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (s.family != "halton" || s.options["digits"] != "permuted") continue;
    for (const std::uint64_t start : {0ULL, (1ULL << 30) - 500}) {
      const auto x = points(
          {.sampler = s.name, .dim = kDim, .start = start, .count = 3000, .n = start + 3000});
      for (std::uint32_t d = rows(s); d < kDim; ++d) {
        const std::uint32_t base = base_of(s, d);
        std::map<std::pair<std::uint32_t, std::uint64_t>, std::uint64_t> image;
        std::set<std::array<std::uint64_t, 3>> arrows;
        for (std::uint64_t i = 0; i < 3000; ++i) {
          std::uint64_t power = base, rest = start + i;
          for (std::uint32_t k = 0; power < 1ULL << 40; ++k, power *= base, rest /= base) {
            const std::uint64_t digit = interval_of(x[i * kDim + d], power) % base;
            INFO(s.name << " base " << base << " position " << k << " index " << start + i);
            REQUIRE(image.try_emplace({k, rest % base}, digit).first->second == digit);
            arrows.insert({k, rest % base, digit});
          }
        }
        std::set<std::pair<std::uint64_t, std::uint64_t>> images;
        for (const auto& arrow : arrows) images.emplace(arrow[0], arrow[2]);
        REQUIRE(images.size() == arrows.size());
      }
    }
  }
}

TEST_CASE(
    "randomized radical inverses: a point of a fixed index is uniform over the replicates, and so "
    "are pairs of points that share a first digit or differ in it",
    "[statistical]") {
  // R = 12,000; 4 samplers x (4 coordinates x 5 statistics) at 1e-9 each: false alarm below 1e-7.
  for (const Sampler& s : with_property("prime-strata")) {
    if (!s.replicable) continue;
    const std::uint32_t dim = 4;
    const auto sets = replicates(s, dim, 81, 12000);
    for (std::uint32_t d = 0; d < dim; ++d) {
      const std::uint64_t base = d < rows(s) ? 3 : base_of(s, d);
      std::array<std::map<std::uint64_t, std::uint32_t>, 3> single;
      std::map<std::array<std::uint64_t, 2>, std::uint32_t> differing;
      std::map<std::array<std::uint64_t, 3>, std::uint32_t> sharing;
      const std::array<std::uint64_t, 3> fixed{0, 1, 80};
      for (const auto& x : sets) {
        const auto place = [&](std::uint64_t i, std::uint64_t n) {
          const double row = std::ldexp(std::floor(x[i * dim + d] * 81), 0);
          const double z = d < rows(s) ? x[i * dim + d] * 81 - row : x[i * dim + d];
          return static_cast<std::uint64_t>(z * static_cast<double>(n));
        };
        for (std::size_t c = 0; c < fixed.size(); ++c) ++single[c][place(fixed[c], 60)];
        ++differing[{place(0, base), place(1, base)}];
        ++sharing[{place(0, base), place(0, base * base) % base, place(base, base * base) % base}];
      }
      INFO(s.name << " coordinate " << d);
      for (const auto& counts : single) check_uniform(counts, 60);
      const bool row = d < rows(s);  // independent jitter
      check_uniform(differing, base * (row ? base : base - 1));
      if (!row) check_uniform(sharing, base * base * (base - 1));
    }
  }
}
