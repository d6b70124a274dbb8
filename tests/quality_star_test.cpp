// The star discrepancy: exact values against brute force and closed forms, bounds against exact
// values.
#include <catch2/catch.hpp>
#include <cmath>

#include "quality/star.hpp"
#include "tests/quality_support.hpp"

using namespace koksma;
using test::drawn;
using test::lcg_points;
using test::quality_kernels;

namespace {

// By the definition: every corner whose coordinates are those of points or 1, open and closed.
double brute_force(const PointSet& p) {
  std::vector<std::vector<double>> grid(p.dim, {1.0});
  for (std::uint64_t i = 0; i < p.size(); ++i)
    for (std::uint32_t j = 0; j < p.dim; ++j) grid[j].push_back(p.at(i, j));
  std::vector<std::size_t> index(p.dim, 0);
  double most = 0;
  while (true) {
    double volume = 1;
    for (std::uint32_t j = 0; j < p.dim; ++j) volume *= grid[j][index[j]];
    double open = 0, closed = 0;
    for (std::uint64_t i = 0; i < p.size(); ++i) {
      bool below = true, within = true;
      for (std::uint32_t j = 0; j < p.dim; ++j) {
        below = below && p.at(i, j) < grid[j][index[j]];
        within = within && p.at(i, j) <= grid[j][index[j]];
      }
      open += below;
      closed += within;
    }
    const auto n = static_cast<double>(p.size());
    most = std::max({most, volume - open / n, closed / n - volume});
    std::uint32_t j = 0;
    while (j < p.dim && ++index[j] == grid[j].size()) index[j++] = 0;
    if (j == p.dim) return most;
  }
}

PointSet midpoints(std::uint64_t n) {
  PointSet set{1, {}};
  for (std::uint64_t i = 0; i < n; ++i)
    set.x.push_back((static_cast<double>(i) + 0.5) / static_cast<double>(n));
  return set;
}

}  // namespace

TEST_CASE("the exact star discrepancy equals brute force, with ties, repeated points and zeros too",
          "[device]") {
  for (const std::uint32_t d : {1U, 2U, 3U})
    for (const std::uint64_t n : {1U, 2U, 15U, 16U, 17U, 33U})
      for (const int shift : {44, 61}) {  // multiples of 2^-20, of 1/8
        const PointSet p = lcg_points(n, d, n + std::uint64_t{100} * d, shift);
        INFO("n = " << n << ", d = " << d << ", shift = " << shift);
        CHECK(star_exact(quality_kernels(), p) == Approx(brute_force(p)).margin(1e-14));
      }
  for (const std::uint32_t d : {1U, 2U, 3U}) {
    CHECK(star_exact(quality_kernels(), {d, std::vector<double>(d, 0.0)}) == 1);
    CHECK(star_exact(quality_kernels(), {d, std::vector<double>(std::size_t{d} * 5, 0.0)}) == 1);
    for (const char* sampler : {"sobol", "lattice"}) {
      const PointSet p = drawn(sampler, 32, d);
      INFO(sampler << ", d = " << d);
      CHECK(star_exact(quality_kernels(), p) == Approx(brute_force(p)).margin(1e-14));
    }
  }
}

TEST_CASE("the midpoint set has star discrepancy 1/(2N), multiples of 1/N have 1/N", "[device]") {
  for (const std::uint64_t n : {1U, 10U, 1000U}) {
    CHECK(star_exact(quality_kernels(), midpoints(n)) ==
          Approx(0.5 / static_cast<double>(n)).margin(1e-14));
    PointSet left{1, {}};
    for (std::uint64_t i = 0; i < n; ++i)
      left.x.push_back(static_cast<double>(i) / static_cast<double>(n));
    CHECK(star_exact(quality_kernels(), left) == Approx(1 / static_cast<double>(n)).margin(1e-14));
  }
}

TEST_CASE("in one dimension it is the formula of the sorted points", "[device]") {
  PointSet p = lcg_points(1000, 1, 8);
  const double found = star_exact(quality_kernels(), p);
  std::sort(p.x.begin(), p.x.end());
  double most = 0;
  for (std::size_t i = 0; i < 1000; ++i)
    most = std::max(most, std::fabs(p.x[i] - (2 * static_cast<double>(i) + 1) / 2000));
  CHECK(found == Approx(most + 1.0 / 2000).margin(1e-14));
}

TEST_CASE("threshold accepting <= exact <= bracketing cover, and both are near", "[device]") {
  for (const std::uint32_t d : {1U, 2U, 3U})
    for (const auto& p : {lcg_points(50, d, d + 6), lcg_points(60, d, d, 61), drawn("sobol", 64, d),
                          drawn("lattice", 64, d)}) {
      const double exact = star_exact(quality_kernels(), p);
      const double lower = star_lower_bound(quality_kernels(), p, {32, 32, 1});
      const StarCover cover = star_upper_bound(quality_kernels(), p, 0.05);
      INFO("d = " << d << ": " << lower << " <= " << exact << " <= " << cover.bound);
      CHECK(lower <= exact + 1e-15);
      CHECK(lower >= 0.95 * exact);
      CHECK(cover.bound >= exact);
      CHECK(cover.bound <= exact + 0.05 + 1e-12);
    }
}

TEST_CASE("short searches find the excess of the volume, too, as boxes grow to critical ones",
          "[device]") {
  // Square roots keep away from 0, so that open boxes hold too few.
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    PointSet p = lcg_points(200, 3, seed);
    for (double& x : p.x) x = std::sqrt(x);
    const double exact = star_exact(quality_kernels(), p);
    const double lower = star_lower_bound(quality_kernels(), p, {16, 8, 1});
    INFO("seed " << seed << ": " << lower << " <= " << exact);
    CHECK(lower <= exact + 1e-15);
    CHECK(lower >= 0.95 * exact);
  }
}

TEST_CASE("above d = 3 the bounds enclose brute force", "[device]") {
  for (const std::uint32_t d : {4U, 5U}) {
    const PointSet p = lcg_points(12, d, d);
    const double exact = brute_force(p);
    const double lower = star_lower_bound(quality_kernels(), p, {32, 32, 1});
    const StarCover cover = star_upper_bound(quality_kernels(), p, 0.2);
    INFO("d = " << d << ": " << lower << " <= " << exact << " <= " << cover.bound);
    CHECK(lower <= exact + 1e-15);
    CHECK(lower >= 0.95 * exact);
    CHECK(cover.bound >= exact);
    CHECK(cover.bound <= exact + 0.2 + 1e-12);
  }
}

TEST_CASE("bounds in fp32 are bounds", "[device]") {
  QualityKernels narrow(test::device(), false);
  for (const std::uint32_t d : {2U, 3U}) {
    PointSet p = lcg_points(64, d, d);
    const double exact = star_exact(quality_kernels(), p);
    CHECK(star_exact(narrow, p) == Approx(exact).margin(1e-6));
    CHECK(star_lower_bound(narrow, p, {32, 16, 1}) <= exact + 1e-15);
    CHECK(star_upper_bound(narrow, p, 0.1).bound >= exact);
  }
}

TEST_CASE("a cover covers: its brackets fill the cube and none is heavier than allowed", "[unit]") {
  // One bracket in one dimension per resolution: N = ceil(1 / resolution) pieces.
  CHECK(cover_size(1, 0.25, 100) == 4U);
  CHECK(cover_size(1, 0.5, 100) == 2U);
  CHECK(cover_size(3, 1, 100) == 1U);
  CHECK_FALSE(cover_size(3, 0.01, 100));
}
