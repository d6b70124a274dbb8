// Rate fits: slopes, interval coverage, exclusions, heavy tails. Synthetic curves with fixed seeds;
// the limits of the statistical tests are five or more standard deviations, a false alarm below
// 1e-6 each.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "estimate/convergence.hpp"

namespace koksma {
namespace {

using Rows = std::vector<ConvergenceRow>;

ConvergenceRow make_row(unsigned log2_samples, std::vector<double> errors) {
  ConvergenceRow row;
  row.samples = std::uint64_t{1} << log2_samples;
  row.errors = std::move(errors);
  return row;
}

// RMSE = 0.3·N^rate for N = 2^first … 2^last; replicates depend on themselves across N with the
// given correlation.
Rows power_law(std::mt19937_64& engine, double rate, std::size_t replicates, unsigned first,
               unsigned last, double correlation = 0) {
  std::normal_distribution<double> normal;
  std::vector<double> path(replicates);
  for (double& state : path) state = normal(engine);
  Rows rows;
  for (unsigned m = first; m <= last; ++m) {
    std::vector<double> errors;
    for (double& state : path) {
      state = correlation * state + std::sqrt(1 - correlation * correlation) * normal(engine);
      errors.push_back(0.3 * std::exp2(rate * m) * state);
    }
    rows.push_back(make_row(m, errors));
  }
  return rows;
}

// Exact power law without noise: |e| = scale·N^rate, alternating in sign.
Rows noiseless(double rate, std::size_t replicates, unsigned first, unsigned last,
               double scale = 1) {
  Rows rows;
  for (unsigned m = first; m <= last; ++m) {
    std::vector<double> errors;
    for (std::size_t r = 0; r < replicates; ++r) {
      errors.push_back(scale * std::exp2(rate * m) * (r % 2 == 0 ? 1 : -1));
    }
    rows.push_back(make_row(m, errors));
  }
  return rows;
}

std::string reason_of(const RateFit& fit, std::uint64_t samples) {
  for (const ExcludedRow& row : fit.excluded) {
    if (row.samples == samples) return row.reason;
  }
  return "";
}

}  // namespace

TEST_CASE("the fitted line of a power law is the law", "[unit][estimate]") {
  const RateFit fit = fit_rate(noiseless(-1.5, 16, 8, 16, 0.3));
  CHECK(*fit.slope == Approx(-1.5));
  CHECK(std::exp2(*fit.intercept) == Approx(0.3));
  CHECK_FALSE(fit_rate(noiseless(-1.5, 16, 8, 11)).intercept);
}

TEST_CASE("power laws give their rate within the designed half-width", "[unit][estimate]") {
  std::mt19937_64 engine(41);
  for (const double rate : {-0.5, -1.0, -1.5, -3.0}) {
    const RateFit fit = fit_rate(power_law(engine, rate, 32, 8, 20));
    REQUIRE(fit.slope);
    REQUIRE(fit.interval);
    // Half-width ±.026 is 1.96 sd for R = 32, M = 13 (page 5, section 3); 5.5 sd here.
    CHECK(*fit.slope == Approx(rate).margin(0.073));
    CHECK(fit.interval->low < *fit.slope);
    CHECK(*fit.slope < fit.interval->high);
    CHECK(fit.interval->high - fit.interval->low == Approx(0.052).margin(0.026));
    CHECK(fit.used.size() == 13);
    CHECK(fit.local_slopes.size() == 12);
    CHECK(fit.excluded.empty());
    CHECK(fit.reason.empty());
    CHECK_FALSE(fit.heavy_tailed);
    CHECK_FALSE(fit.median_slope);
  }
}

TEST_CASE("bootstrap intervals cover the rate about 95 times in 100, dependent rows or not",
          "[unit][estimate]") {
  std::mt19937_64 engine(42);
  constexpr int kTrials = 500;
  FitOptions options;
  options.resamples = 400;
  for (const double correlation : {0.0, 0.7}) {
    int covered = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const RateFit fit = fit_rate(power_law(engine, -1.5, 32, 8, 16, correlation), options);
      covered += fit.interval->low <= -1.5 && -1.5 <= fit.interval->high ? 1 : 0;
    }
    // A percentile bootstrap of 32 replicates covers 93 % or so; binomial sd 0.011.
    INFO("coverage " << covered / double{kTrials} << " at correlation " << correlation);
    CHECK(covered / double{kTrials} > 0.86);
    CHECK(covered / double{kTrials} < 0.99);
  }
}

TEST_CASE("a fit is the same on every call and in any order of rows", "[unit][estimate]") {
  std::mt19937_64 engine(43);
  Rows rows = power_law(engine, -1, 32, 8, 16);
  const RateFit fit = fit_rate(rows);
  std::shuffle(rows.begin(), rows.end(), engine);
  const RateFit again = fit_rate(rows);
  CHECK(again.slope == fit.slope);
  CHECK(again.interval->low == fit.interval->low);
  CHECK(again.interval->high == fit.interval->high);
  CHECK(again.used == fit.used);
}

TEST_CASE("noiseless curves have exact slopes at any scale", "[unit][estimate]") {
  for (const double scale : {1.0, 0x1p-1000, 0x1p900}) {
    const RateFit fit = fit_rate(noiseless(-1.25, 8, 8, 15, scale));
    CHECK(*fit.slope == Approx(-1.25).epsilon(1e-12));
    CHECK(fit.interval->high - fit.interval->low < 1e-12);
    for (const LocalSlope& local : fit.local_slopes) {
      CHECK(local.slope == Approx(-1.25).epsilon(1e-12));
      CHECK(local.to == 2 * local.from);
    }
  }
}

TEST_CASE("rows near their floor are excluded and do not bend the rate", "[unit][estimate]") {
  std::mt19937_64 engine(44);
  Rows rows = power_law(engine, -1.5, 32, 8, 20);
  std::normal_distribution<double> noise(0, 0.3 * std::exp2(-1.5 * 15));
  for (ConvergenceRow& row : rows) {
    row.floor = noise.stddev();
    for (double& error : row.errors) error += noise(engine);
  }
  const RateFit fit = fit_rate(rows);
  CHECK(*fit.slope == Approx(-1.5).margin(0.2));
  CHECK(fit.used.back() == 1U << 13U);
  CHECK(reason_of(fit, 1U << 14U) == "below the floor: RMSE < 3 F");
  CHECK(fit.excluded.size() == 7);
  // Where no floor is known, the flat end is still seen.
  for (ConvergenceRow& row : rows) row.floor = 0;
  CHECK(fit_rate(rows).plateau.kind == PlateauKind::structural);
}

TEST_CASE("every excluded row says why", "[unit][estimate]") {
  Rows rows = noiseless(-1, 4, 8, 16);
  rows.push_back(make_row(7, {1, 1, 1, 1}));
  rows.push_back(make_row(17, {1, 1, 1}));
  rows.push_back(make_row(18, {}));
  rows.push_back(make_row(19, {0, 0, 0, 0}));
  rows.push_back(make_row(20, {1, std::nan(""), 1, 1}));
  rows.push_back(make_row(21, {1, 1, 1, 1}));
  rows.back().mean_abs = 1.5;
  rows.push_back(make_row(22, {1, 1, 1, 1}));
  rows.back().n_eff = 29;
  rows.push_back(make_row(23, {1, 1, 1, 1}));
  rows.back().samples = 1000;
  rows.push_back(make_row(10, {1, 1, 1, 1}));
  const RateFit fit = fit_rate(rows);
  CHECK(*fit.slope == Approx(-1));
  CHECK(fit.used.size() == 9);
  CHECK(fit.excluded.size() == 9);
  CHECK(reason_of(fit, 1U << 7U) == "N < 2^8");
  CHECK(reason_of(fit, 1U << 17U) == "another number of replicates");
  CHECK(reason_of(fit, 1U << 18U) == "no replicates");
  CHECK(reason_of(fit, 1U << 19U) == "RMSE = 0");
  CHECK(reason_of(fit, 1U << 20U) == "a replicate is not finite");
  CHECK(reason_of(fit, 1U << 21U) == "unresolved: RMSE > E|f|/2");
  CHECK(reason_of(fit, 1U << 22U) == "unresolved: n_eff < 30");
  CHECK(reason_of(fit, 1000) == "N is not a power of two");
  CHECK(reason_of(fit, 1U << 10U) == "N repeated");
}

TEST_CASE("fewer than six usable rows give no rate but a reason", "[unit][estimate]") {
  CHECK(fit_rate(noiseless(-1, 4, 8, 13)).slope);
  const RateFit fit = fit_rate(noiseless(-1, 4, 8, 12));
  CHECK_FALSE(fit.slope);
  CHECK_FALSE(fit.interval);
  CHECK(fit.reason == "fewer than 6 usable rows");
  CHECK(fit.local_slopes.size() == 4);
  CHECK_FALSE(fit_rate({}).slope);
}

TEST_CASE("a deterministic curve has a slope and never an interval", "[unit][estimate]") {
  const RateFit fit = fit_rate(noiseless(-1, 1, 8, 16));
  CHECK(*fit.slope == Approx(-1));
  CHECK_FALSE(fit.interval);
  CHECK(fit.deterministic);
  CHECK_FALSE(fit.heavy_tailed);
  CHECK(fit.reason == "deterministic: no interval");
}

TEST_CASE("fewer than 8 replicates give a slope without an interval", "[unit][estimate]") {
  std::mt19937_64 engine(47);
  const RateFit few = fit_rate(power_law(engine, -1, 7, 8, 16));
  CHECK(few.slope);
  CHECK_FALSE(few.interval);
  CHECK(few.reason == "fewer than 8 replicates: no interval");
  CHECK(fit_rate(power_law(engine, -1, 8, 8, 16)).interval);
}

TEST_CASE("heavy tails are flagged and bring the slope of the median", "[unit][estimate]") {
  std::mt19937_64 engine(45);
  Rows rows = power_law(engine, -1.5, 32, 8, 16);
  rows[4].errors[3] *= 1000;
  // One row of nine may be chance, or errors on a coarse grid at small N.
  CHECK_FALSE(fit_rate(rows).heavy_tailed);
  rows[2].errors[7] *= 1000;
  rows[6].errors[5] *= 1000;
  const RateFit fit = fit_rate(rows);
  CHECK(fit.heavy_tailed);
  REQUIRE(fit.median_slope);
  REQUIRE(fit.median_interval);
  // The sd of log2 median is about 1.7 times that of log2 RMSE; five sd for 9 rows.
  CHECK(*fit.median_slope == Approx(-1.5).margin(0.2));
  CHECK(fit.median_interval->low < *fit.median_slope);
  CHECK(*fit.median_slope < fit.median_interval->high);
}

TEST_CASE("median intervals cover the rate about 95 times in 100", "[unit][estimate]") {
  std::mt19937_64 engine(46);
  constexpr int kTrials = 400;
  FitOptions options;
  options.resamples = 300;
  options.infinite_variance = true;
  int covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const RateFit fit = fit_rate(power_law(engine, -1, 32, 8, 16), options);
    REQUIRE_FALSE(fit.slope);
    covered += fit.median_interval->low <= -1 && -1 <= fit.median_interval->high ? 1 : 0;
  }
  INFO("coverage " << covered / double{kTrials});
  CHECK(covered / double{kTrials} > 0.86);
}

TEST_CASE("with infinite variance only the median is fitted and no row is unresolved",
          "[unit][estimate]") {
  Rows rows = noiseless(-0.25, 9, 8, 16);
  for (ConvergenceRow& row : rows) {
    row.mean_abs = 1e-9;
    row.n_eff = 1;
    row.errors[0] = 1e6 * static_cast<double>(row.samples);
  }
  FitOptions options;
  options.infinite_variance = true;
  const RateFit fit = fit_rate(rows, options);
  CHECK_FALSE(fit.slope);
  REQUIRE(fit.median_slope);
  CHECK(*fit.median_slope == Approx(-0.25));
  CHECK(fit.local_slopes.front().slope == Approx(-0.25));
  CHECK(fit.reason == "infinite variance: only the median is fitted");
}

TEST_CASE("weights follow the kurtosis: a noisy row counts less", "[unit][estimate]") {
  // Nine exact rows and one that is off; concentrating its error in one replicate must pull the
  // slope less.
  const auto slope_with = [](const std::vector<double>& errors) {
    Rows rows = noiseless(-1, 16, 8, 16);
    rows.push_back(make_row(17, errors));
    return *fit_rate(rows).slope;
  };
  const double level = std::exp2(-15);
  std::vector<double> concentrated(16, 1e-12);
  concentrated[0] = 4 * level;
  const double spread_pull = slope_with(std::vector<double>(16, level)) + 1;
  const double concentrated_pull = slope_with(concentrated) + 1;
  CHECK(concentrated_pull > 0);
  CHECK(concentrated_pull < spread_pull / 4);
}

TEST_CASE("resamples without an error leave no interval", "[unit][estimate]") {
  Rows rows = noiseless(-1, 16, 8, 14);
  for (ConvergenceRow& row : rows) std::fill(row.errors.begin() + 1, row.errors.end(), 0.0);
  const RateFit fit = fit_rate(rows);
  CHECK(*fit.slope == Approx(-1));
  CHECK_FALSE(fit.interval);
  CHECK(fit.reason == "too few resamples have a slope");
  CHECK(fit.heavy_tailed);
  CHECK_FALSE(fit.median_slope);
}

}  // namespace koksma
