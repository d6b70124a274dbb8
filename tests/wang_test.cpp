// Wang tiles: tiles whose edges agree fit together without two points too near, whatever the
// tiling, and samples are the points of a tiling of the torus.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "points/tables.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::points;
using koksma::test::PointsSpec;

namespace {

constexpr const char* kName = "wang-tiles";
constexpr std::size_t kTypes = 16;

// The words after the first: x and y [type][rank], in units of 2^-30 tiles, plus one tile.
struct Tiles {
  std::size_t ranks;
  double declared;
  std::vector<double> coordinates;

  explicit Tiles(std::uint64_t seed) {
    const Sampler s = test::catalog().sampler(kName, "test");
    ranks = s.options["points"];
    declared = s.options["minimum_distance"];
    PointRequest request;
    request.options = s.options;
    request.dim = 2;
    request.seed = seed;
    for (const std::uint64_t word : find_table_builder(s.family)(request).words)
      coordinates.push_back(std::ldexp(static_cast<double>(word), -30) - 1);
  }
  double at(std::size_t axis, std::size_t type, std::size_t rank) const {
    return coordinates[1 + (axis * kTypes + type) * ranks + rank];
  }
  double nearest(std::size_t a, std::size_t b, double dx, double dy) const {
    double least = INFINITY;
    const bool itself = a == b && dx == 0 && dy == 0;
    for (std::size_t i = 0; i < ranks; ++i)
      for (std::size_t j = 0; j < ranks; ++j) {
        const double x = at(0, b, j) + dx - at(0, a, i), y = at(1, b, j) + dy - at(1, a, i);
        if (!itself || i != j) least = std::min(least, x * x + y * y);
      }
    return std::sqrt(least);
  }
};

std::size_t colour(std::size_t type, unsigned edge) { return type >> edge & 1; }

double circle(double a, double b) {
  const double d = std::fabs(a - b);
  return std::min(d, 1 - d);
}

double minimum_distance(const std::vector<double>& xy) {
  double least = INFINITY;
  for (std::size_t i = 0; i < xy.size(); i += 2)
    for (std::size_t j = 0; j < i; j += 2)
      least = std::min(least, std::hypot(circle(xy[i], xy[j]), circle(xy[i + 1], xy[j + 1])));
  return least;
}

}  // namespace

TEST_CASE("tiles beside each other keep the distance wherever their edges agree", "[unit]") {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Tiles tiles(seed);
    const double least = tiles.declared / std::sqrt(static_cast<double>(tiles.ranks));
    for (std::size_t a = 0; a < kTypes; ++a) {
      REQUIRE(tiles.nearest(a, a, 0, 0) >= least);
      for (std::size_t b = 0; b < kTypes; ++b) {
        INFO("types " << a << ", " << b);
        if (colour(a, 1) == colour(b, 0)) REQUIRE(tiles.nearest(a, b, 1, 0) >= least);
        if (colour(a, 3) == colour(b, 2)) REQUIRE(tiles.nearest(a, b, 0, 1) >= least);
        REQUIRE(tiles.nearest(a, b, 1, 1) >= least);
        REQUIRE(tiles.nearest(a, b, -1, 1) >= least);
      }
    }
  }
}

TEST_CASE("full tilings keep the declared distance, others a good part of it", "[device]") {
  const Tiles tiles(1);
  for (const std::uint64_t n : {64U, 100U, 256U, 300U, 600U, 1024U, 2000U, 4096U})
    for (const std::uint32_t r : {0U, 1U, 2U}) {
      const auto drawn = points({.sampler = kName, .dim = 2, .count = n, .replicate = r, .n = n});
      const double scaled = minimum_distance(drawn) * std::sqrt(static_cast<double>(n));
      const bool full = n == 256 || n == 1024 || n == 4096;
      INFO("N = " << n << ": " << scaled);
      CHECK(scaled >= (full ? tiles.declared * (1 - 1e-7) : 0.35));
    }
}

TEST_CASE("all samples of a tiling differ, up to many tiles, and every tile gets its share",
          "[device]") {
  const std::uint64_t n = 40000;  // 16 x 16 tiles, the last rank in a part of them
  const auto drawn = points({.sampler = kName, .dim = 2, .count = n, .n = n});
  std::set<std::pair<double, double>> seen;
  std::array<double, 256> counts{};
  for (std::size_t i = 0; i < drawn.size(); i += 2) {
    seen.emplace(drawn[i], drawn[i + 1]);
    ++counts[static_cast<std::size_t>(drawn[i] * 16) * 16 +
             static_cast<std::size_t>(drawn[i + 1] * 16)];
  }
  CHECK(seen.size() == n);
  // Squares as large as tiles, anywhere: 156 points and a few that straddle the border.
  for (const double count : counts) CHECK(std::fabs(count - 156.25) <= 32);
}

TEST_CASE("replicates and seeds have tilings of their own, not only shifts", "[device]") {
  // Distances to the nearest neighbour, sorted, do not see shifts and the order of the points.
  const auto fingerprint = [&](std::uint32_t r, std::uint64_t seed) {
    const auto xy = points(
        {.sampler = kName, .dim = 2, .count = 1024, .replicate = r, .seed = seed, .n = 1024});
    std::vector<double> nearest(1024, INFINITY);
    for (std::size_t i = 0; i < 1024; ++i)
      for (std::size_t j = 0; j < 1024; ++j)
        if (i != j)
          nearest[i] = std::min(nearest[i], std::hypot(circle(xy[2 * i], xy[2 * j]),
                                                       circle(xy[2 * i + 1], xy[2 * j + 1])));
    std::sort(nearest.begin(), nearest.end());
    return nearest;
  };
  const auto first = fingerprint(0, 1);
  for (const auto& other : {fingerprint(1, 1), fingerprint(2, 1), fingerprint(0, 2)}) {
    std::size_t differ = 0;
    for (std::size_t i = 0; i < 1024; ++i) differ += std::fabs(first[i] - other[i]) > 1e-8 ? 1 : 0;
    CHECK(differ > 512);
  }
}

TEST_CASE("tiled samples are uniform at a fixed index over 10^4 replicates", "[statistical]") {
  // chi-squared, 63 degrees of freedom: above 155 with probability 6e-10. Fixed seed.
  const std::uint64_t n = 3000;
  const std::uint32_t replicates = 10000;
  const Plan plan = make_points_plan(test::catalog(), kName, 2, Precision::fp64, n, replicates, 1,
                                     test::device().facts());
  PointsDump dump(test::device(), plan);
  for (const std::uint64_t index : {0U, 1499U, 2999U}) {
    std::array<double, 64> counts{};
    for (std::uint32_t r = 0; r < replicates; ++r) {
      const auto xy = dump.read(index, 1, n, r, 4);
      ++counts[static_cast<std::size_t>(std::floor(xy[0] * 8) * 8 + std::floor(xy[1] * 8))];
    }
    double chi2 = 0;
    for (const double count : counts) chi2 += (count - 156.25) * (count - 156.25) / 156.25;
    INFO("index " << index << ": chi2 = " << chi2);
    CHECK(chi2 < 155);
  }
}

TEST_CASE("tiled samples are the same from any start, in both precisions and at all widths",
          "[device]") {
  for (const std::uint64_t n : {7U, 200U, 900U, 60000U}) {
    const PointsSpec all{
        .sampler = kName, .dim = 2, .count = n, .replicate = 3, .log2_block = 4, .n = n};
    const auto fine = points(all);
    INFO("N = " << n);
    PointsSpec replayed = all;
    replayed.log2_block = 16;
    REQUIRE(fine == points(replayed));
    PointsSpec part = all;
    part.start = n / 3;
    part.count = n / 2;
    const auto middle = points(part);
    REQUIRE(
        std::equal(middle.begin(), middle.end(), fine.begin() + static_cast<long>(2 * part.start)));
    PointsSpec narrow = all;
    narrow.precision = Precision::fp32;
    const auto coarse = points(narrow);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      REQUIRE(std::floor(std::ldexp(fine[i], 23)) == std::floor(std::ldexp(coarse[i], 23)));
      REQUIRE((fine[i] > 0 && fine[i] < 1 && coarse[i] > 0 && coarse[i] < 1));
    }
    for (const std::uint32_t lanes : {1U, 4U, 8U}) {
      PointsSpec wide = all;
      wide.lanes_per_item = lanes;
      REQUIRE(points(wide) == fine);
      wide.precision = Precision::fp32;
      REQUIRE(points(wide) == coarse);
    }
  }
}
