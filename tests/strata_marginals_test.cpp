// Randomization of the stratified samplers, over many replicates: every sample by itself is
// uniform, two samples are as independent as their strata allow, and variances are those of theory.
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "catalog/sizes.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::two_sided_chi2;
using test::has_property;

namespace {

constexpr std::uint32_t kStrataReplicates = 10000;

// Sets of n points, one per replicate.
struct Replicates {
  std::uint64_t n;
  std::uint32_t dim;
  std::vector<std::vector<double>> sets;  // [replicate][point * dim + dimension]

  double operator()(std::uint32_t r, std::size_t point, std::size_t d) const {
    return sets[r][point * dim + d];
  }
  std::uint64_t stratum(std::uint32_t r, std::size_t point, std::size_t d, std::uint64_t of) const {
    return static_cast<std::uint64_t>((*this)(r, point, d) * static_cast<double>(of));
  }
};

Replicates draw(const Sampler& s, std::uint32_t dim, std::uint64_t at_least) {
  Replicates result{test::admitted_size(s, dim, at_least), dim, {}};
  const Plan plan = make_points_plan(test::catalog(), s.name, dim, Precision::fp64, result.n,
                                     kStrataReplicates, 1, test::device().facts());
  PointsDump dump(test::device(), plan);
  for (std::uint32_t r = 0; r < kStrataReplicates; ++r)
    result.sets.push_back(dump.read(0, result.n, result.n, r, 5));
  return result;
}

// The dimensions in which a sampler's declared strata are tested, and how many cells of a set there
// are along them.
struct Cells {
  std::uint32_t dim = 5;
  std::vector<std::pair<std::size_t, std::uint64_t>> axes;  // (dimension, strata)
};

// Pairs of samples: the declared cells of the last pair, or row of the last dimension. (The first
// pair of a net keeps its order, so there two samples are not exchangeable.)
std::vector<Cells> declared_cells(const Sampler& s, std::uint64_t n) {
  std::vector<Cells> result;
  if (has_property(s, "one-per-stratum")) {
    const auto m = static_cast<std::uint64_t>(std::llround(std::sqrt(static_cast<double>(n))));
    result.push_back({2, {{0, m}, {1, m}}});
  }
  if (has_property(s, "one-per-cell-2d")) {
    auto a = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(n)));
    while (n % a != 0) --a;
    result.push_back({5, {{2, a}, {3, n / a}}});
    result.push_back({5, {{4, n}}});
  }
  if (has_property(s, "one-per-row"))
    for (const std::size_t d : {2UL, 3UL, 4UL}) result.push_back({5, {{d, n}}});
  return result;
}

std::uint32_t dim_of(const Sampler& s) {
  return has_property(s, "one-per-stratum") || has_property(s, "two-per-stratum") ? 2 : 5;
}

// 10^4 sets of 12 points or the next number, drawn once for all tests.
const Replicates& replicates_of(const Sampler& s) {
  static std::map<std::string, Replicates> drawn;
  const auto& [place, fresh] = drawn.try_emplace(s.name);
  if (fresh) place->second = draw(s, dim_of(s), 12);
  return place->second;
}

// Every sampler of which the tests know strata.
template <typename Check>
void for_all_replicates(const Check& check) {
  std::size_t found = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!s.replicable || declared_cells(s, 16).empty()) continue;
    ++found;
    const Replicates& x = replicates_of(s);
    INFO(s.name << " N = " << x.n);
    check(s, x);
  }
  CHECK(found >= 6);
}

// Probability of counts at least as uneven as these, if all cells were equally likely.
double evenness(const std::vector<double>& counts) {
  double total = 0, statistic = 0;
  for (const double c : counts) total += c;
  const double expected = total / static_cast<double>(counts.size());
  for (const double c : counts) statistic += (c - expected) * (c - expected) / expected;
  const boost::math::chi_squared distribution(static_cast<double>(counts.size()) - 1);
  return cdf(complement(distribution, statistic));
}

double mean_error(const Replicates& x, std::uint32_t r, std::size_t d) {
  double sum = 0;
  for (std::size_t i = 0; i < x.n; ++i) sum += x(r, i, d) - 0.5;
  return sum / static_cast<double>(x.n);
}

}  // namespace

TEST_CASE("every sample by itself is uniform in every dimension", "[statistical]") {
  // Chi-squared on 32 parts over 10^4 replicates, at three indices: about 100 tests of 1e-8.
  for_all_replicates([](const Sampler&, const Replicates& x) {
    for (const std::size_t i : {std::size_t{0}, std::size_t{5}, x.n - 1}) {
      for (std::uint32_t d = 0; d < x.dim; ++d) {
        std::vector<double> counts(32, 0);
        for (std::uint32_t r = 0; r < kStrataReplicates; ++r) ++counts[x.stratum(r, i, d, 32)];
        INFO("sample " << i << " dimension " << d);
        CHECK(evenness(counts) > 1e-8);
      }
    }
  });
}

TEST_CASE("dimensions of a sample are independent, within a pair and between pairs",
          "[statistical]") {
  // 8 x 8 parts, all pairs of dimensions at two indices: about 100 tests of 1e-8.
  for_all_replicates([](const Sampler&, const Replicates& x) {
    for (const std::size_t i : {std::size_t{0}, std::size_t{7}}) {
      for (std::uint32_t d = 0; d < x.dim; ++d) {
        for (std::uint32_t e = 0; e < d; ++e) {
          std::vector<double> counts(64, 0);
          for (std::uint32_t r = 0; r < kStrataReplicates; ++r)
            ++counts[x.stratum(r, i, d, 8) * 8 + x.stratum(r, i, e, 8)];
          INFO("sample " << i << " dimensions " << e << " and " << d);
          CHECK(evenness(counts) > 1e-8);
        }
      }
    }
  });
}

TEST_CASE("the strata of two samples are uniform on all pairs of different strata",
          "[statistical]") {
  // 132 or 240 pairs, 10^4 replicates, 4 pairs of samples: about 70 tests of 1e-8.
  for_all_replicates([](const Sampler& s, const Replicates& x) {
    for (const Cells& cells : declared_cells(s, x.n)) {
      const auto cell = [&](std::uint32_t r, std::size_t i) {
        std::uint64_t result = 0;
        for (const auto& [d, strata] : cells.axes)
          result = result * strata + x.stratum(r, i, d, strata);
        return result;
      };
      for (const auto& [i, j] : std::initializer_list<std::pair<std::size_t, std::size_t>>{
               {0, 1}, {0, 2}, {3, 7}, {0, 11}}) {
        std::vector<double> counts(x.n * (x.n - 1), 0);
        for (std::uint32_t r = 0; r < kStrataReplicates; ++r) {
          const std::uint64_t a = cell(r, i), b = cell(r, j);
          REQUIRE(a != b);
          ++counts[a * (x.n - 1) + (b > a ? b - 1 : b)];
        }
        INFO("samples " << i << " and " << j << ", dimension " << cells.axes.front().first);
        CHECK(evenness(counts) > 1e-8);
      }
    }
  });
}

TEST_CASE("the places of a sample inside its row are uniform and independent of the row",
          "[statistical]") {
  for_all_replicates([](const Sampler& s, const Replicates& x) {
    if (!has_property(s, "one-per-row")) return;
    for (std::uint32_t d = 0; d < x.dim; ++d) {
      std::vector<double> counts(8 * x.n, 0);
      for (std::uint32_t r = 0; r < kStrataReplicates; ++r) ++counts[x.stratum(r, 3, d, 8 * x.n)];
      INFO("dimension " << d);
      CHECK(evenness(counts) > 1e-8);
    }
  });
}

TEST_CASE("one-per-row: 12 N^3 Var of the mean of x_1 + ... + x_d is d", "[statistical]") {
  // 6-definitions 11. Means of 12 or 16 uniform places are nearly normal: chi-squared of 10^4
  // replicates, false alarm below 1e-7 each.
  for_all_replicates([](const Sampler& s, const Replicates& x) {
    if (!has_property(s, "one-per-row")) return;
    double m2 = 0;
    for (std::uint32_t r = 0; r < kStrataReplicates; ++r) {
      double e = 0;
      for (std::uint32_t d = 0; d < x.dim; ++d) e += mean_error(x, r, d);
      m2 += e * e;
    }
    const double scaled = 12 * std::pow(static_cast<double>(x.n), 3) * m2 / x.dim;
    INFO("12 N^3 Var / d = " << scaled / kStrataReplicates);
    CHECK(two_sided_chi2(scaled, kStrataReplicates) > 1e-7);
  });
}

TEST_CASE(
    "one-per-stratum: the mean of x has variance 1 / (12 m^2 N), which is 1 / (12 N^3) at d = 1",
    "[statistical]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!has_property(s, "one-per-stratum") || !s.replicable) continue;
    for (const std::uint32_t dim : {1U, 2U}) {
      const Replicates x = draw(s, dim, 12);
      const double m = std::round(std::pow(static_cast<double>(x.n), 1.0 / dim));
      for (std::uint32_t d = 0; d < dim; ++d) {
        double m2 = 0;
        for (std::uint32_t r = 0; r < kStrataReplicates; ++r)
          m2 += std::pow(mean_error(x, r, d), 2);
        INFO(s.name << " dimension " << d + 1 << " of " << dim << " N = " << x.n);
        CHECK(two_sided_chi2(12 * m * m * static_cast<double>(x.n) * m2, kStrataReplicates) > 1e-7);
      }
    }
  }
}

TEST_CASE("replicates are independent: means and single samples of neighbours are uncorrelated",
          "[statistical]") {
  // 6 standard deviations, false alarm 2e-9 each.
  for_all_replicates([](const Sampler&, const Replicates& x) {
    for (std::uint32_t d = 0; d < x.dim; ++d) {
      double means = 0, square = 0, samples = 0;
      for (std::uint32_t r = 0; r + 1 < kStrataReplicates; ++r) {
        means += mean_error(x, r, d) * mean_error(x, r + 1, d);
        square += mean_error(x, r, d) * mean_error(x, r, d);
        samples += 12 * (x(r, 2, d) - 0.5) * (x(r + 1, 2, d) - 0.5);
      }
      INFO("dimension " << d);
      CHECK(std::fabs(means / square) < 6 / std::sqrt(kStrataReplicates));
      CHECK(std::fabs(samples / kStrataReplicates) < 6 / std::sqrt(kStrataReplicates));
    }
  });
}

TEST_CASE(
    "multi-jittered points draw the substrata of two columns independently, unless they are "
    "correlated",
    "[statistical]") {
  // The same row of columns 0 and 1: b x b substrata over 10^4 replicates.
  for_all_replicates([](const Sampler& s, const Replicates& x) {
    if (s.family != "multijitter") return;
    auto a = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(x.n)));
    while (x.n % a != 0) --a;
    const std::uint64_t b = x.n / a;
    std::vector<double> counts(b * b, 0);
    for (std::uint32_t r = 0; r < kStrataReplicates; ++r) {
      std::uint64_t substrata[2] = {};
      for (std::size_t i = 0; i < x.n; ++i)
        if (x.stratum(r, i, 1, b) == 1 && x.stratum(r, i, 0, a) < 2)
          substrata[x.stratum(r, i, 0, a)] = x.stratum(r, i, 0, x.n) % b;
      ++counts[substrata[0] * b + substrata[1]];
    }
    CHECK((evenness(counts) > 1e-8) != has_property(s, "correlated-substrata"));
  });
}
