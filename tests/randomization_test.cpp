// Randomization is random: to the last bit, in every dimension and replicate; tables and vectors
// are what they should be.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "catalog/embedded.hpp"
#include "points/matrices.hpp"
#include "points/tables.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// Coordinate `d` of point `i` as its 52 bits.
std::uint64_t word52(const std::vector<double>& points, std::size_t dim, std::size_t i,
                     std::size_t d) {
  return static_cast<std::uint64_t>(std::ldexp(points[i * dim + d], 52));
}

// Words drawn at random: all different, and every one of their low `bits` bits is set about half
// the time.
void check_random_bits(const std::vector<std::uint64_t>& words, int bits) {
  CHECK(std::set<std::uint64_t>(words.begin(), words.end()).size() == words.size());
  const auto count = static_cast<double>(words.size());
  for (int b = 0; b < bits; ++b) {
    double ones = 0;
    for (const std::uint64_t word : words) ones += static_cast<double>(word >> b & 1);
    INFO("bit " << b << " is set in " << ones << " of " << count);
    CHECK(std::fabs(ones - count / 2) <= 3 * std::sqrt(count));
  }
}

}  // namespace

TEST_CASE(
    "the first point of a randomized sampler is random to the last bit, anew in every dimension "
    "and replicate",
    "[statistical]") {
  // It is the shift, or hashed from keys alone. Fixed seed; 6 standard deviations per bit.
  const std::uint32_t replicates = 64;
  for (const Sampler& s : test::catalog().samplers) {
    if (!s.replicable || !test::complete(s)) continue;
    const std::uint32_t dim = test::usual_dim(s);
    // One point is all of its set's freedom: strata of a larger set fix the first bits.
    const std::uint64_t n = s.extensible ? 16 : test::admitted_size(s, dim, 1);
    const Plan plan = make_points_plan(test::catalog(), s.name, dim, Precision::fp64, n, replicates,
                                       1, test::device().facts());
    PointsDump dump(test::device(), plan);
    std::vector<std::uint64_t> words;
    for (std::uint32_t r = 0; r < replicates; ++r) {
      const auto drawn = dump.read(0, 1, n, r, 4);
      for (std::uint32_t d = 0; d < dim; ++d) words.push_back(word52(drawn, dim, 0, d));
    }
    INFO(s.name);
    check_random_bits(words, 52);
  }
}

TEST_CASE(
    "linear scrambling multiplies by unit lower triangular matrices of random bits, another in "
    "every dimension and replicate",
    "[statistical]") {
  // Point 2^(k+1) - 1 is column k away from point 0. Column 0 of every matrix product is the first
  // column of L; in dimension 1, whose matrix is the identity, column k is column k of L.
  const std::uint32_t dim = 8, replicates = 32, m = 10;
  const Plan plan = make_points_plan(test::catalog(), "sobol-lms-shift", dim, Precision::fp64,
                                     1 << m, replicates, 1, test::device().facts());
  PointsDump dump(test::device(), plan);
  std::vector<std::uint64_t> words;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const auto drawn = dump.read(0, 1 << m, 1 << m, r, m);
    const auto column = [&](std::uint32_t k, std::uint32_t d) {
      return word52(drawn, dim, (2U << k) - 1, d) ^ word52(drawn, dim, 0, d);
    };
    for (std::uint32_t k = 0; k < m; ++k) {
      INFO("replicate " << r << " column " << k);
      REQUIRE(column(k, 0) >> (51 - k) == 1);
      words.push_back(column(k, 0) & ((1ULL << 42) - 1));
    }
    for (std::uint32_t d = 1; d < dim; ++d) words.push_back(column(0, d) & ((1ULL << 42) - 1));
  }
  check_random_bits(words, 42);
}

TEST_CASE("sobol reaches its last index, 2^52 - 1", "[device]") {
  // Column 51 is the last there is: point 2^52 - 1 is that column alone.
  const std::uint64_t start = (1ULL << 52) - 8;
  const auto drawn = test::points({.sampler = "sobol", .dim = 7, .start = start, .count = 8});
  const GeneratingMatrices m = sobol_matrices(7, 52);
  for (std::uint64_t i = 0; i < 8; ++i) {
    const std::uint64_t gray = (start + i) ^ (start + i) >> 1;
    for (std::size_t j = 0; j < 7; ++j) {
      std::uint64_t word = 0;
      for (std::size_t k = 0; k < 52; ++k)
        if ((gray >> k & 1) != 0) word ^= m.words[k * 7 + j];
      INFO("point " << i << " dimension " << j);
      REQUIRE(word52(drawn, 7, i, j) == word >> 12);
    }
  }
}

TEST_CASE("all of Random123's known answers of Philox4x32-10 hold for the host's draws", "[unit]") {
  // kat_vectors of Random123 1.14: all zero, all ones, digits of pi.
  const auto draw = [](std::uint64_t seed, std::uint64_t index, std::uint32_t replicate,
                       std::uint32_t last) {
    return random_pair(seed, index, replicate, static_cast<RandomPurpose>(last >> 24),
                       last & 0xFFFFFFU);
  };
  const RandomPair ones = draw(~0ULL, ~0ULL, ~0U, ~0U);
  CHECK(ones.first == 0x408f276d41c83b0eU);
  CHECK(ones.second == 0xa20bc7c66d5451fdU);
  const RandomPair pi = draw(0x299f31d0a4093822U, 0x85a308d3243f6a88U, 0x13198a2eU, 0x03707344U);
  CHECK(pi.first == 0xd16cfe0994fdccebU);
  CHECK(pi.second == 0x5001e42024126ea1U);
}

TEST_CASE(
    "the generating vectors are good: their error at 2^10 points is near that of a vector built "
    "for it",
    "[unit]") {
  // e^2 = -1 + mean of prod (1 + 2 pi^2 B_2(x_j) / j^2), against plain component-by-component.
  constexpr std::uint64_t kSize = 1 << 10;
  std::array<double, kSize> kernel{};
  for (std::uint64_t i = 0; i < kSize; ++i) {
    const double x = static_cast<double>(i) / kSize;
    kernel[i] = 2 * M_PI * M_PI * (x * x - x + 1.0 / 6);
  }
  for (const char* name : {"cbc", "korobov"}) {
    const std::string path = std::string("kernels/points/vectors/") + name + ".json";
    const auto z = parse_json(embedded_text(path), "test")["z"].get<std::vector<std::uint64_t>>();
    std::vector<double> ours(kSize, 1), best(kSize, 1);
    const auto multiply = [&](std::vector<double>& product, std::uint64_t component, double d) {
      double mean = 0;
      for (std::uint64_t i = 0; i < kSize; ++i) {
        product[i] *= 1 + kernel[i * component % kSize] / (d * d);
        mean += product[i] / kSize;
      }
      return mean - 1;
    };
    for (std::size_t j = 0; j < 16; ++j) {
      double least = INFINITY;
      std::uint64_t chosen = 1;
      for (std::uint64_t candidate = 1; candidate < kSize / 2; candidate += 2) {
        double sum = 0;
        for (std::uint64_t i = 0; i < kSize; ++i) sum += best[i] * kernel[i * candidate % kSize];
        if (sum < least) least = sum, chosen = candidate;
      }
      const double d = static_cast<double>(j + 1);
      const double ratio = multiply(ours, z[j], d) / multiply(best, chosen, d);
      INFO(name << " in " << d << " dimensions: " << ratio);
      REQUIRE(z[j] % 2 == 1);
      REQUIRE(ratio < 2.5);
    }
  }
}
