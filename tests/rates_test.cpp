// What must hold of errors: gated rates, plain Monte Carlo's variance, uniformity of nested
// scrambling, heavy tails marked.
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "estimate/measure.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::two_sided_chi2;

namespace {

// Least-squares slope of log2 RMSE over the rows that the fit used, also where they are too few for
// a fit of its own.
double slope_over_used(const CellResult& result) {
  std::vector<double> x, y;
  for (const Row& row : result.rows) {
    const auto& used = result.rate.used;
    if (std::find(used.begin(), used.end(), row.n) == used.end()) continue;
    x.push_back(std::log2(static_cast<double>(row.n)));
    y.push_back(std::log2(*row.errors.rmse));
  }
  const double count = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / count;
  double covariance = 0, variance = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    covariance += (x[i] - mean_x) * y[i];
    variance += (x[i] - mean_x) * (x[i] - mean_x);
  }
  return covariance / variance;
}

struct Moments {
  double mean, variance, kurtosis;
};

// Of the estimates of many replicates of N points.
Moments moments_of(const std::string& scene, const std::string& sampler, std::uint64_t n,
                   std::uint32_t replicates) {
  const Cell cell = test::cell(scene, sampler, n, replicates);
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell, test::device().facts()));
  const Row row = prepared.run_row(n);
  double m2 = 0, m4 = 0, mean = 0;
  for (const double q : row.estimates) mean += q / replicates;
  for (const double q : row.estimates) {
    const double e = q - *prepared.exact().mean;
    m2 += e * e / replicates;
    m4 += e * e * e * e / replicates;
  }
  return {mean, m2, m4 / (m2 * m2)};
}

}  // namespace

TEST_CASE(
    "gated rates hold: nested scrambling on smooth, kink and axis-jump scenes with d <= 2, the "
    "oblique indicator at d = 2",
    "[statistical]") {
  // 5-numerics 1.9, "Gates": tolerance 0.15 is 5 standard deviations of the slope at R = 32 (false
  // alarm below 1e-6 each).
  std::size_t gated = 0;
  for (const char* scene :
       {"genz-oscillatory:d=1", "genz-oscillatory:d=2", "genz-gaussian:d=1", "genz-gaussian:d=2",
        "genz-product-peak:d=1", "genz-product-peak:d=2", "genz-corner-peak:d=1",
        "genz-corner-peak:d=2", "linear-prod:d=2", "genz-c0:d=1,h=10", "genz-discontinuous:d=2",
        "simplex-indicator:d=2"}) {
    const CellResult result = test::run_sizes(scene, "sobol-owen", "2^8..2^16", 32);
    INFO(scene << ": slope " << *result.rate.slope << ", target "
               << result.verdict.target.value_or(0) << ", " << result.verdict.verdict);
    CHECK(result.verdict.verdict == "within-gate");
    ++gated;
  }
  CHECK(gated == 12);
}

TEST_CASE("nested scrambling is at most at rate -1.25 on smooth scenes at d = 2 and 3",
          "[statistical]") {
  // Measured -1.31 to -1.44 over 2^8 ... 2^16; the standard deviation of a slope is 0.03.
  for (const char* sampler : {"sobol-owen", "niederreiter-owen"}) {
    for (const char* scene :
         {"genz-oscillatory:d=2", "genz-oscillatory:d=3", "genz-gaussian:d=2", "genz-gaussian:d=3",
          "genz-corner-peak:d=2", "linear-prod:d=2", "linear-prod:d=3", "x2-1mx2:d=2"}) {
      const CellResult result = test::run_sizes(scene, sampler, "2^8..2^16", 32);
      INFO(sampler << " " << scene << ": slope " << *result.rate.slope);
      CHECK(*result.rate.slope <= -1.25);
    }
  }
}

TEST_CASE("interlaced nets at d = 1: order 2 at most at rate -2.2, order 3 at most at -3.0",
          "[statistical]") {
  // Theory -2.5 and -3.5 (Dick 2011); the standard deviation of a slope is 0.03 over 9 rows, 0.06
  // over the 6 that order 3 leaves above the floor.
  for (const char* scene : {"genz-gaussian:d=1", "genz-oscillatory:d=1", "genz-corner-peak:d=1"}) {
    for (const auto& [sampler, bound] :
         {std::pair{"sobol-interlaced-2", -2.2}, {"sobol-interlaced-3", -3.0}}) {
      const CellResult result = test::run_sizes(scene, sampler, "2^8..2^16", 32);
      const double slope = slope_over_used(result);
      INFO(sampler << " " << scene << ": slope " << slope << " over " << result.rate.used.size());
      REQUIRE(result.rate.used.size() >= 4);
      CHECK(slope <= bound);
      CHECK(result.verdict.verdict != "outside-gate");
    }
  }
}

TEST_CASE(
    "a shifted tent lattice is at most at rate -1.8 on smooth non-periodic scenes, d = 1 and 2",
    "[statistical]") {
  for (const char* scene : {"genz-gaussian:d=1", "genz-oscillatory:d=1", "genz-oscillatory:d=2",
                            "genz-corner-peak:d=1", "genz-corner-peak:d=2"}) {
    const CellResult result = test::run_sizes(scene, "lattice-shift-tent", "2^8..2^16", 32);
    INFO(scene << ": slope " << *result.rate.slope);
    CHECK(*result.rate.slope <= -1.8);
    // At d = 2 the bound is two standard deviations away, so that other seeds are not gated there.
    CHECK(result.verdict.verdict == (result.cell.scene.dim == 1 ? "within-gate" : "reported"));
  }
}

TEST_CASE("shifted lattices are at rate -4 on a Korobov alpha = 4 scene at d = 1",
          "[statistical]") {
  // From 2^12 or 2^13 on the error is rounding: the rows before that are fitted.
  for (const char* sampler : {"lattice-shift", "lattice-random"}) {
    const CellResult result = test::run_sizes("x2-1mx2:d=1", sampler, "2^8..2^16", 32);
    const double slope = slope_over_used(result);
    INFO(sampler << ": slope " << slope << " over " << result.rate.used.size());
    REQUIRE(result.rate.used.size() >= 4);
    CHECK(std::fabs(slope + 4) <= 0.15);
  }
}

TEST_CASE("gated rates hold: the shifted lattice at d = 1 on a non-periodic smooth scene",
          "[statistical]") {
  for (const char* scene : {"genz-gaussian:d=1", "genz-oscillatory:d=1", "genz-corner-peak:d=1"}) {
    const CellResult result = test::run_sizes(scene, "lattice-shift", "2^8..2^16", 32);
    INFO(scene << ": slope " << *result.rate.slope);
    CHECK(result.verdict.verdict == "within-gate");
  }
}

TEST_CASE("random passes the chi-squared test against the exact variance in every row",
          "[statistical]") {
  // Two-sided at 1e-6 / rows (Bonferroni): false alarm of the whole test 1e-6.
  std::vector<CellResult> results;
  std::size_t rows = 0;
  for (const char* scene : {"genz-oscillatory:d=5", "genz-gaussian:d=2", "genz-discontinuous:d=2",
                            "simplex-indicator:d=2", "keister:d=5", "sobol-g:d=8", "ishigami",
                            "linear-prod:d=100,power=1", "gauss-ridge-cos:d=10"}) {
    results.push_back(test::run_sizes(scene, "random", "2^8..2^14", 64));
    rows += results.back().rows.size();
  }
  for (const CellResult& result : results) {
    for (const Row& row : result.rows) {
      INFO(result.cell.scene.text << " N = " << row.n << ": " << row.mc_test.reason
                                  << " p = " << row.mc_test.p_value.value_or(-1));
      // Small N may be unresolved (n_eff < 30), never large ones.
      REQUIRE((row.mc_test.applicable || row.n < 1024));
      CHECK_FALSE(contradicts_variance(row.mc_test, rows));
    }
  }
}

TEST_CASE(
    "nested scrambling by hashing is uniform: 12 N^3 Var = 1 on f = x, and kurtosis as theory says",
    "[statistical]") {
  // Under nested uniform scrambling the mean of N van der Corput points is a mean of N independent
  // uniforms on strata of length 1/N: variance 1/(12 N^3), kurtosis 3 - 1.2/N. R = 10^4;
  // chi-squared at 1e-7 each, kurtosis within 6 standard deviations sqrt(24/R): false alarm of the
  // whole test below 1e-6.
  const std::uint32_t replicates = 10000;
  for (const std::uint64_t n : {1ULL << 4, 1ULL << 8, 1ULL << 12}) {
    const Moments m = moments_of(test::kIdentity, "sobol-owen", n, replicates);
    const double ratio = 12 * std::pow(static_cast<double>(n), 3) * m.variance;
    INFO("N = " << n << ": 12 N^3 Var = " << ratio << ", kurtosis " << m.kurtosis);
    CHECK(two_sided_chi2(ratio * replicates, replicates) > 1e-7);
    CHECK(std::fabs(m.kurtosis - (3 - 1.2 / static_cast<double>(n))) <
          6 * std::sqrt(24.0 / replicates));
  }
}

TEST_CASE("nested scrambling is uniform in fp32 and in a later dimension too", "[statistical]") {
  // Chi-squared at 1e-7 each.
  const std::uint32_t replicates = 2000;
  const std::uint64_t n = 256;
  Cell cell = test::cell(test::kIdentity, "sobol-owen", n, replicates);
  cell.precision = Precision::fp32;
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell, test::device().facts()));
  const Row row = prepared.run_row(n);
  const double ratio = 12 * std::pow(256.0, 3) * *row.errors.rmse * *row.errors.rmse;
  INFO("fp32: 12 N^3 Var = " << ratio);
  CHECK(two_sided_chi2(ratio * replicates, replicates) > 1e-7);

  // Dimension 6 of 6: mean of the points themselves.
  Plan plan = make_points_plan(test::catalog(), "sobol-owen", 6, Precision::fp64, 16, replicates, 1,
                               test::device().facts());
  PointsDump dump(test::device(), plan);
  double m2 = 0, cross = 0;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const auto x = dump.read(0, 16, 16, r, 4);
    double last = 0, first = 0;
    for (std::size_t i = 0; i < 16; ++i)
      first += (x[6 * i] - 0.5) / 16, last += (x[6 * i + 5] - 0.5) / 16;
    m2 += last * last;
    cross += first * last;
  }
  const double variance = 1 / (12 * std::pow(16.0, 3));
  CHECK(two_sided_chi2(m2 / variance, replicates) > 1e-7);
  // Independent dimensions: the correlation is within 6 / sqrt(R), false alarm 2e-9.
  CHECK(std::fabs(cross / variance / replicates) < 6 / std::sqrt(static_cast<double>(replicates)));
}

TEST_CASE(
    "linear scrambling with a shift is marked heavy-tailed where it is, nested scrambling is not",
    "[statistical]") {
  // 5-numerics section 3: at d = 1 LMS + shift has RMSE / median |e| above 10^4 on x e^x at N =
  // 4096, Owen 1.5.
  const CellResult linear =
      test::run_sizes("genz-gaussian:d=1", "sobol-lms-shift", "2^8..2^16", 32);
  CHECK(linear.rate.heavy_tailed);
  CHECK(linear.rate.median_slope);
  CHECK(linear.verdict.verdict != "within-gate");
  CHECK(linear.verdict.verdict != "outside-gate");
  CHECK_FALSE(
      test::run_sizes("genz-gaussian:d=1", "sobol-owen", "2^8..2^16", 32).rate.heavy_tailed);
}

TEST_CASE("a rate is not fitted through the fp32 floor, also where E|f| is unknown and I nearly 0",
          "[statistical]") {
  // I is 5e-7 here, so a floor in units of |I| would be far below the rounding of values near 1.
  Cell cell = test::cell("genz-oscillatory:d=1,w=0.033800469", "sobol-owen", 256, 32);
  cell.precision = Precision::fp32;
  cell.n = parse_sizes("2^8..2^20", "test");
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell, test::device().facts()));
  const CellResult result = prepared.run();
  // 0.2 u sqrt(E f^2), E f^2 about 1/2; it was 4 u before the factor was measured.
  CHECK(result.floor == Approx(0.2 * 0x1p-24 * std::sqrt(0.5)).epsilon(0.2));
  REQUIRE_FALSE(result.rate.used.empty());
  CHECK(result.rate.used.back() < 1U << 18);
  CHECK(result.verdict.verdict != "outside-gate");
}

TEST_CASE("independent points are judged by their exact variance", "[statistical]") {
  const CellResult good = test::run_sizes("genz-gaussian:d=2", "random", "2^8..2^14", 64);
  CHECK(good.verdict.verdict == "within-gate");
  CHECK(good.verdict.reason == "chi-squared test against the exact variance");
}

TEST_CASE("neither random nor sobol-owen is marked heavy-tailed in the default study",
          "[statistical]") {
  const Study study = read_study(test::catalog(), "", {});
  for (Cell cell : study.cells) {
    if (cell.sampler != "random" && cell.sampler != "sobol-owen") continue;
    cell.n = parse_sizes("2^8..2^14", "test");
    PreparedCell prepared(test::catalog(), test::device(), test::device(),
                          make_plan(test::catalog(), cell, test::device().facts()));
    INFO(cell.scene.text << " " << cell.sampler);
    CHECK_FALSE(prepared.run().rate.heavy_tailed);
  }
}
