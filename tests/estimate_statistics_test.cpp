// Error statistics of replicates and the sample variance. Statistical tests have fixed seeds and
// limits at five or more standard deviations: false-alarm probability below 1e-6 each.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "estimate/statistics.hpp"
#include "tests/numbers.hpp"

namespace koksma {
namespace {

using test::kInfinity;

std::vector<double> normal_values(std::mt19937_64& engine, std::size_t size, double mean = 0) {
  std::normal_distribution<double> normal(mean, 1);
  std::vector<double> values(size);
  for (double& value : values) value = normal(engine);
  return values;
}

// Sums as the kernel makes them, with the square in double.
std::optional<double> variance_of(const std::vector<double>& values, double y0) {
  ExactSum sum;
  ExactSum squares;
  for (const double y : values) {
    sum.add(y);
    squares.add((y - y0) * (y - y0));
  }
  return sample_variance(values.size(), sum, squares, y0);
}

}  // namespace

TEST_CASE("interval factors of the RMSE are those of page 5, section 3", "[unit][estimate]") {
  struct Known {
    std::size_t replicates;
    double low;
    double high;
  };
  for (const Known& known : {Known{8, .675, 1.916}, Known{16, .745, 1.522}, Known{32, .804, 1.323},
                             Known{64, .853, 1.209}, Known{128, .891, 1.140}}) {
    const Interval factors = rmse_factors(known.replicates);
    CHECK(factors.low == Approx(known.low).margin(6e-4));
    CHECK(factors.high == Approx(known.high).margin(6e-4));
  }
}

TEST_CASE("statistics of a small example are those computed by hand", "[unit][estimate]") {
  const std::vector<double> estimates = {11, 9, 12, 8, 14};
  const ErrorStatistics s = summarise_errors(estimates, 10.0);
  CHECK(s.replicates == 5);
  CHECK(s.mean == Approx(10.8));
  CHECK(s.bias == Approx(0.8));
  CHECK(s.sd == Approx(std::sqrt(22.8 / 4)));
  CHECK(s.rmse == Approx(std::sqrt(26.0 / 5)));
  CHECK(s.median_abs == 2.0);
  CHECK(s.rho == Approx(std::sqrt(26.0 / 5) / 2));
  CHECK_FALSE(s.heavy_tailed);
  // m4/m2² of deviations 0.2, −1.8, 1.2, −2.8, 3.2.
  CHECK(s.kurtosis == Approx((0.0016 + 10.4976 + 2.0736 + 61.4656 + 104.8576) / 5 / 20.7936));
  CHECK(s.rmse_interval_method == "chi-squared");
  CHECK(s.rmse_low == Approx(*s.rmse * rmse_factors(5).low));
  CHECK(s.rmse_high == Approx(*s.rmse * rmse_factors(5).high));
}

TEST_CASE("the RMSE interval covers the true RMSE of normal errors 95 times in 100",
          "[unit][estimate]") {
  std::mt19937_64 engine(11);
  constexpr int kTrials = 4000;
  int covered = 0;
  int chi_squared = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const ErrorStatistics s = summarise_errors(normal_values(engine, 32), 0.0);
    covered += *s.rmse_low <= 1 && 1 <= *s.rmse_high ? 1 : 0;
    chi_squared += s.rmse_interval_method == "chi-squared" ? 1 : 0;
  }
  // Binomial sd 0.0035: limits at more than 5 sd. Kurtosis (1 %) and bias (0.3 %) seldom send a
  // sample elsewhere.
  CHECK(covered / double{kTrials} == Approx(0.95).margin(0.02));
  CHECK(chi_squared / double{kTrials} == Approx(0.987).margin(0.01));
}

TEST_CASE("the kurtosis test rejects 1 % of normal samples of any size", "[unit][estimate]") {
  std::mt19937_64 engine(12);
  constexpr int kTrials = 10000;
  for (const std::size_t size : {8U, 16U, 32U, 128U}) {
    int rejected = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const ErrorStatistics s = summarise_errors(normal_values(engine, size), std::nullopt);
      rejected += kurtosis_is_normal(*s.kurtosis, size) ? 0 : 1;
    }
    // Binomial sd 0.001; the approximation itself is good to half a percent from n = 8 on.
    CHECK(rejected / double{kTrials} == Approx(0.010).margin(0.010));
  }
  CHECK_FALSE(kurtosis_is_normal(30, 32));
  CHECK_FALSE(kurtosis_is_normal(1, 32));
  CHECK(kurtosis_is_normal(3, 32));
}

TEST_CASE("one wild replicate is heavy-tailed and its interval is a bootstrap",
          "[unit][estimate]") {
  std::mt19937_64 engine(13);
  std::vector<double> estimates = normal_values(engine, 32);
  estimates[7] = 100;
  const ErrorStatistics s = summarise_errors(estimates, 0.0);
  CHECK(s.heavy_tailed);
  CHECK(*s.rho > 10);
  CHECK(*s.kurtosis > 25);
  CHECK(s.rmse_interval_method == "bootstrap");
  CHECK(*s.rmse_low < 2);
  CHECK(*s.rmse_high > *s.rmse);
  const ErrorStatistics again = summarise_errors(estimates, 0.0);
  CHECK(again.rmse_low == s.rmse_low);
  CHECK(again.rmse_high == s.rmse_high);
}

TEST_CASE("a bias beyond three standard errors rules the chi-squared interval out",
          "[unit][estimate]") {
  std::mt19937_64 engine(14);
  const ErrorStatistics s = summarise_errors(normal_values(engine, 32, 5), 0.0);
  CHECK(s.rmse_interval_method == "bootstrap");
  CHECK(*s.rmse_low < *s.rmse);
  CHECK(*s.rmse < *s.rmse_high);
  CHECK(*s.rmse_high - *s.rmse_low < 1.0);
}

TEST_CASE("one replicate has an error and nothing else", "[unit][estimate]") {
  const ErrorStatistics s = summarise_errors(std::vector<double>{3}, 5.0);
  CHECK(s.rmse == 2.0);
  CHECK(s.bias == -2.0);
  CHECK(s.median_abs == 2.0);
  CHECK_FALSE(s.sd);
  CHECK_FALSE(s.kurtosis);
  CHECK_FALSE(s.rmse_low);
  CHECK_FALSE(s.rmse_high);
  CHECK(s.rmse_interval_method.empty());
  CHECK_FALSE(s.heavy_tailed);
}

TEST_CASE("constant replicates give exact zeros and no ratios", "[unit][estimate]") {
  const ErrorStatistics exact = summarise_errors(std::vector<double>(7, 0.1), 0.1);
  CHECK(exact.sd == 0.0);
  CHECK(exact.rmse == 0.0);
  CHECK(exact.median_abs == 0.0);
  CHECK_FALSE(exact.rho);
  CHECK_FALSE(exact.kurtosis);
  CHECK_FALSE(exact.rmse_low);
  CHECK_FALSE(exact.heavy_tailed);

  const ErrorStatistics one_off =
      summarise_errors(std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, 0.0);
  CHECK(one_off.median_abs == 0.0);
  CHECK_FALSE(one_off.rho);
  CHECK(one_off.heavy_tailed);
}

TEST_CASE("without an exact value there are estimates but no errors", "[unit][estimate]") {
  for (const auto exact : {std::optional<double>(), std::optional<double>(kInfinity)}) {
    const ErrorStatistics s = summarise_errors(std::vector<double>{1, 2, 3}, exact);
    CHECK(s.mean == 2.0);
    CHECK(s.sd == 1.0);
    CHECK_FALSE(s.rmse);
    CHECK_FALSE(s.bias);
    CHECK_FALSE(s.median_abs);
  }
}

TEST_CASE("a non-finite replicate is counted and silences every statistic", "[unit][estimate]") {
  const ErrorStatistics s = summarise_errors(std::vector<double>{1, kInfinity, std::nan("")}, 1.0);
  CHECK(s.replicates == 3);
  CHECK(s.nonfinite == 2);
  CHECK_FALSE(s.mean);
  CHECK_FALSE(s.sd);
  CHECK_FALSE(s.rmse);
  CHECK(summarise_errors({}, 1.0).replicates == 0);
}

TEST_CASE("statistics scale exactly with powers of two up to the ends of the range",
          "[unit][estimate]") {
  const std::vector<double> unit = {1.25, 0.75, 1.125, 0.5, 1};
  const ErrorStatistics reference = summarise_errors(unit, 1.0);
  for (const int exponent : {1010, -1000}) {
    std::vector<double> scaled;
    for (const double value : unit) scaled.push_back(std::ldexp(value, exponent));
    const ErrorStatistics s = summarise_errors(scaled, std::ldexp(1.0, exponent));
    CHECK(*s.rmse == std::ldexp(*reference.rmse, exponent));
    CHECK(*s.sd == std::ldexp(*reference.sd, exponent));
    CHECK(*s.kurtosis == *reference.kurtosis);
    CHECK(*s.rho == *reference.rho);
  }
}

TEST_CASE("the variance of u survives an offset of 1e8", "[unit][estimate]") {
  constexpr std::uint64_t kCount = 1U << 16U;
  std::vector<double> values;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    values.push_back(1e8 + (static_cast<double>(i) + 0.5) / kCount);
  }
  // Var of the midpoints is (1 − N^-2)/12; N/(N − 1) makes it unbiased.
  const double n = kCount;
  CHECK(*variance_of(values, values[12345]) ==
        Approx((1 - 1 / n / n) / 12 * n / (n - 1)).epsilon(1e-14));
}

TEST_CASE("the variance of a constant is exactly zero about any shift", "[unit][estimate]") {
  std::mt19937_64 engine(15);
  std::uniform_real_distribution<double> uniform(-10, 10);
  for (int trial = 0; trial < 2000; ++trial) {
    const double constant = std::exp(uniform(engine));
    const double shift = trial % 2 == 0 ? constant : uniform(engine);
    REQUIRE(variance_of(std::vector<double>(3 + engine() % 100, constant), shift) == 0.0);
  }
}

TEST_CASE("a variance is never negative and agrees with two passes", "[unit][estimate]") {
  std::mt19937_64 engine(16);
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<double> values = normal_values(engine, 2 + engine() % 50);
    // Below 2^-40 the long double mean of the reference would not be good enough.
    const double spread = std::exp2(-static_cast<double>(engine() % 40));
    long double mean = 0;
    for (double& value : values) {
      value = 1 + spread * value;
      mean += value;
    }
    mean /= static_cast<long double>(values.size());
    long double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const auto expected =
        static_cast<double>(squares / static_cast<long double>(values.size() - 1));

    REQUIRE(*variance_of(values, 0) >= 0);
    const double variance = *variance_of(values, values.front());
    REQUIRE(variance >= 0);
    REQUIRE(variance == Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("a variance is absent for one value and for squares beyond double", "[unit][estimate]") {
  CHECK_FALSE(variance_of({1}, 1));
  CHECK_FALSE(variance_of({0x1p1010, 0x1.8p1010, 0x1p1009}, 0x1p1010));
  CHECK_FALSE(variance_of({1, kInfinity}, 1));
  // Values of 2^500: the sum of squares still fits, and the variance is that of 1 and 2.
  CHECK(variance_of({0x1p500, 0x1p501}, 0x1p500) == 0x1p999);
}

}  // namespace koksma
