// Stratified points keep what their catalog entries declare: one point per stratum, row or cell, in
// exact arithmetic, at many N, in both precisions and for every replicate.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "catalog/sizes.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::stratum;
using test::has_property;

namespace {

// The different sizes of a sampler next to a list of sizes, powers of two and others.
std::set<std::uint64_t> sizes_of(const Sampler& s, std::uint32_t dim) {
  std::set<std::uint64_t> sizes;
  for (const std::uint64_t n : {1U, 2U, 3U, 5U, 12U, 16U, 33U, 100U, 243U, 1000U, 1024U, 4999U})
    sizes.insert(test::admitted_size(s, dim, n));
  return sizes;
}

struct Set {
  std::uint64_t n;
  std::vector<double> x;  // [point][dimension]
};

// Calls check(set) for every size, precision and, of randomized sets, two replicates.
template <typename Check>
void for_all_sets(const Sampler& s, std::uint32_t dim, const Check& check) {
  for (const Precision precision : test::kPrecisions) {
    for (const std::uint64_t n : sizes_of(s, dim)) {
      for (const std::uint32_t r :
           s.replicable ? std::vector<std::uint32_t>{0, 3} : std::vector<std::uint32_t>{0}) {
        INFO(s.name << " d = " << dim << " N = " << n << " replicate " << r << " "
                    << precision_name(precision));
        check(Set{n, test::points({.sampler = s.name,
                                   .dim = dim,
                                   .precision = precision,
                                   .count = n,
                                   .replicate = r,
                                   .n = n})});
      }
    }
  }
}

// The numbers are 0 ... n-1 in some order.
bool all_taken_once(const std::vector<std::uint64_t>& numbers, std::uint64_t n) {
  std::vector<bool> taken(n, false);
  for (const std::uint64_t k : numbers) {
    if (k >= n || taken[k]) return false;
    taken[k] = true;
  }
  return numbers.size() == n;
}

// Strata of the whole cube, whose number grows with the dimension.
bool has_grid(const Sampler& s) {
  return has_property(s, "one-per-stratum") || has_property(s, "two-per-stratum");
}

bool one_per_row(const Set& set, std::uint32_t dim, std::uint32_t d) {
  std::vector<std::uint64_t> rows;
  for (std::size_t i = 0; i < set.n; ++i) rows.push_back(stratum(set.x[i * dim + d], set.n));
  return all_taken_once(rows, set.n);
}

}  // namespace

TEST_CASE("one-per-stratum, two-per-stratum: each cell of the grid holds one point, or a pair",
          "[device]") {
  std::set<std::size_t> found;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_grid(s)) continue;
    const std::size_t draws = has_property(s, "two-per-stratum") ? 2 : 1;
    found.insert(draws);
    for (const std::uint32_t dim : {1U, 2U, 3U}) {
      for_all_sets(s, dim, [&](const Set& set) {
        const std::uint64_t strata = set.n / draws;
        const auto m = static_cast<std::uint64_t>(
            std::llround(std::pow(static_cast<double>(strata), 1.0 / dim)));
        std::vector<std::uint64_t> cells;
        for (std::size_t i = 0; i < set.n; ++i) {
          std::uint64_t cell = 0;
          for (std::uint32_t d = dim; d-- > 0;) cell = cell * m + stratum(set.x[i * dim + d], m);
          if (i % draws == 0) cells.push_back(cell);
          REQUIRE(cell == cells.back());
        }
        REQUIRE(all_taken_once(cells, strata));
        // Deterministic cells come in the order of their numbers, dimension 0 fastest.
        REQUIRE((s.replicable || std::is_sorted(cells.begin(), cells.end())));
      });
    }
  }
  CHECK(found.size() == 2);
}

TEST_CASE("one-per-row: every coordinate has one point in each of N rows", "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-row")) continue;
    ++found;
    for_all_sets(s, 5, [&](const Set& set) {
      for (std::uint32_t d = 0; d < 5; ++d) REQUIRE(one_per_row(set, 5, d));
    });
  }
  CHECK(found >= 4);
}

TEST_CASE(
    "one-per-cell-2d: each pair of dimensions has one point in each cell of the grid nearest to a "
    "square, an odd last dimension one in each of N rows",
    "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-cell-2d")) continue;
    ++found;
    for_all_sets(s, 5, [&](const Set& set) {
      std::uint64_t a = 1;
      for (std::uint64_t k = 1; k * k <= set.n; ++k)
        if (set.n % k == 0) a = k;
      const std::uint64_t b = set.n / a;
      for (const std::uint32_t d : {0U, 2U}) {
        std::vector<std::uint64_t> cells;
        for (std::size_t i = 0; i < set.n; ++i)
          cells.push_back(stratum(set.x[i * 5 + d], a) * b + stratum(set.x[i * 5 + d + 1], b));
        REQUIRE(all_taken_once(cells, set.n));
      }
      REQUIRE(one_per_row(set, 5, 4));
    });
  }
  CHECK(found >= 4);
}

TEST_CASE("no-duplicates: all points of a set differ", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "no-duplicates")) continue;
    // Programs of the tests above.
    const std::uint32_t dim = has_grid(s) ? 3 : std::min(5U, s.max_dim);
    for_all_sets(s, dim, [&](const Set& set) {
      std::set<std::vector<double>> seen;
      for (auto x = set.x.begin(); x != set.x.end(); x += dim) seen.emplace(x, x + dim);
      REQUIRE(seen.size() == set.n);
    });
  }
}

TEST_CASE(
    "net-per-pair: in every pair of dimensions, all elementary intervals of N points hold one",
    "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "net-per-pair")) continue;
    ++found;
    for_all_sets(s, 5, [&](const Set& set) {
      const auto m = static_cast<unsigned>(std::bit_width(set.n) - 1);
      for (const std::uint32_t d : {0U, 2U}) {
        for (unsigned q = 0; q <= m; ++q) {
          std::vector<std::uint64_t> boxes;
          for (std::size_t i = 0; i < set.n; ++i)
            boxes.push_back(stratum(set.x[i * 5 + d], 1ULL << q) << (m - q) |
                            stratum(set.x[i * 5 + d + 1], 1ULL << (m - q)));
          REQUIRE(all_taken_once(boxes, set.n));
        }
      }
    });
  }
  CHECK(found >= 1);
}

TEST_CASE("the first pair of 02 holds the points of sobol-owen in two dimensions", "[device]") {
  // The two are one net under one scramble, in other orders.
  for (const Precision precision : test::kPrecisions) {
    std::set<std::pair<double, double>> sets[2];
    for (const bool padded : {false, true}) {
      const std::uint32_t dim = padded ? 5 : 2;
      const auto x = test::points({.sampler = padded ? "02" : "sobol-owen",
                                   .dim = dim,
                                   .precision = precision,
                                   .count = 1024,
                                   .replicate = 3,
                                   .n = 1024});
      for (std::size_t i = 0; i < 1024; ++i) sets[padded].emplace(x[i * dim], x[i * dim + 1]);
    }
    CHECK(sets[0].size() == 1024);
    CHECK(sets[0] == sets[1]);
  }
}

TEST_CASE(
    "correlated-substrata: all columns share one permutation of their substrata; multi-jittered "
    "points without it have another in each",
    "[device]") {
  std::size_t shared = 0, own = 0;
  const std::uint64_t a = 16, n = a * a;
  for (const Sampler& s : test::catalog().samplers) {
    if (s.family != "multijitter") continue;
    const auto x = test::points({.sampler = s.name, .dim = 5, .count = n, .n = n});
    for (const std::size_t d : {0UL, 1UL, 2UL, 3UL}) {
      std::set<std::vector<std::uint64_t>> permutations;
      std::vector<std::vector<std::uint64_t>> lines(a, std::vector<std::uint64_t>(a));
      for (std::size_t i = 0; i < n; ++i)
        lines[stratum(x[5 * i + d], a)][stratum(x[5 * i + (d ^ 1)], a)] =
            stratum(x[5 * i + d], n) % a;
      permutations.insert(lines.begin(), lines.end());
      INFO(s.name << " dimension " << d);
      CHECK(permutations.size() == (has_property(s, "correlated-substrata") ? 1 : a));
    }
    ++(has_property(s, "correlated-substrata") ? shared : own);
  }
  CHECK(shared == 1);
  CHECK(own == 1);
}

TEST_CASE("the largest set of a sampler can be drawn at its end, in any blocks", "[device]") {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "no-duplicates") || s.extensible) continue;
    ++found;
    const std::uint32_t dim = has_grid(s) ? 3 : std::min(5U, s.max_dim);
    const std::uint64_t n = nearest_sizes(s, dim, 1ULL << s.max_log2_n).below.value();
    test::PointsSpec spec{.sampler = s.name, .dim = dim};
    spec.start = n - 100;
    spec.count = 100;
    spec.n = n;
    const auto x = test::points(spec);
    spec.log2_block = 4;
    INFO(s.name << " N = " << n);
    REQUIRE(x == test::points(spec));
    CHECK(n > 1ULL << 29);
    std::set<std::vector<double>> seen;
    for (auto point = x.begin(); point != x.end(); point += dim) seen.emplace(point, point + dim);
    CHECK(seen.size() == 100);
    for (std::uint32_t d = 0; d < dim && has_property(s, "one-per-row"); ++d) {
      std::set<std::uint64_t> rows;
      for (std::size_t i = 0; i < 100; ++i) rows.insert(stratum(x[i * dim + d], n));
      CHECK(rows.size() == 100);
    }
  }
  CHECK(found >= 7);
}

TEST_CASE("a regular grid has its cells' centres, cut off to the coordinate's bits", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-stratum") || s.replicable) continue;
    for (const Precision precision : test::kPrecisions) {
      const int bits = precision == Precision::fp32 ? 23 : 52;
      for (const std::uint64_t m : {1U, 2U, 3U, 7U, 10U, 64U, 100U}) {
        const auto x = test::points(
            {.sampler = s.name, .dim = 2, .precision = precision, .count = m * m, .n = m * m});
        for (std::size_t i = 0; i < x.size(); ++i) {
          const std::uint64_t cell = i % 2 == 0 ? i / 2 % m : i / 2 / m;
          const std::uint64_t twice = 2 * m;
          const auto units = static_cast<std::uint64_t>(
              (static_cast<unsigned __int128>(2 * cell + 1) << bits) / twice);
          INFO(s.name << " m = " << m << " value " << i);
          REQUIRE(x[i] == std::ldexp(static_cast<double>(units), -bits));
        }
      }
    }
  }
}

TEST_CASE(
    "fp32 draws the strata of fp64: the same 23 bits where N is a power of two, at most one unit "
    "away elsewhere",
    "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-row") && !has_property(s, "one-per-cell-2d")) continue;
    for (const std::uint64_t n : sizes_of(s, 5)) {
      const auto fine = test::points({.sampler = s.name, .dim = 5, .count = n, .n = n});
      const auto coarse = test::points(
          {.sampler = s.name, .dim = 5, .precision = Precision::fp32, .count = n, .n = n});
      const double allowed = std::has_single_bit(n) ? 0 : 1;
      std::size_t off = 0;
      for (std::size_t i = 0; i < fine.size(); ++i) {
        const double steps =
            std::fabs(std::floor(std::ldexp(fine[i], 23)) - std::floor(std::ldexp(coarse[i], 23)));
        INFO(s.name << " N = " << n << " value " << i);
        REQUIRE(steps <= allowed);
        off += steps > 0;
      }
      // Only where a centre lies across the border: in about N of the grid's 2^23 steps.
      CHECK(off <= 6 + fine.size() * n / (1 << 22));
    }
  }
}
