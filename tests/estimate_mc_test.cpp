// The chi-squared test of plain Monte Carlo.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "estimate/mc_test.hpp"

namespace koksma {
namespace {

// Errors of R means of N uniform values; with `copies` > 1 every value is drawn that many times.
std::vector<double> uniform_errors(std::mt19937_64& engine, std::size_t replicates,
                                   std::size_t samples, std::size_t copies) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<double> errors(replicates, 0.0);
  for (double& error : errors) {
    for (std::size_t i = 0; i < samples; i += copies) {
      error += static_cast<double>(copies) * uniform(engine);
    }
    error /= static_cast<double>(samples);
  }
  return errors;
}

}  // namespace

TEST_CASE("p-values are two-sided chi-squared tails", "[unit][estimate]") {
  // T = 5 · 2² = 20 with 5 degrees of freedom: P(χ²_5 ≥ 20) = 0.001249731.
  const std::vector<double> errors(5, 2.0 / 8);
  const McTest test = test_mc_variance(errors, 64, 1.0, 0.0);
  REQUIRE(test.applicable);
  CHECK(*test.statistic == Approx(20));
  CHECK(*test.p_value == Approx(2 * 0.001249731).epsilon(1e-6));
  // T = 0: the lower tail is empty.
  CHECK(test_mc_variance(std::vector<double>(5, 0.0), 64, 1.0, 0.0).p_value == 0.0);
}

TEST_CASE("independent streams raise a false alarm as often as stated", "[unit][estimate]") {
  std::mt19937_64 engine(31);
  constexpr int kTrials = 4000;
  int below = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const McTest test = test_mc_variance(uniform_errors(engine, 32, 64, 1), 64, 1.0 / 12, -1.2);
    REQUIRE(test.applicable);
    below += *test.p_value < 0.05 ? 1 : 0;
    // At 1e-6 / 4000 rows for the whole test.
    REQUIRE_FALSE(contradicts_variance(test, kTrials));
  }
  // Binomial sd 0.0035: false alarm below 1e-6.
  CHECK(below / double{kTrials} == Approx(0.05).margin(0.0175));
}

TEST_CASE("duplicated streams are detected", "[unit][estimate]") {
  std::mt19937_64 engine(32);
  // Every value four times: T is four times what it should be. And one replicate repeated is no
  // contradiction of the mean of T, so the test must see the copies inside a replicate.
  const McTest test = test_mc_variance(uniform_errors(engine, 32, 256, 4), 256, 1.0 / 12, -1.2);
  CHECK(contradicts_variance(test, 100));
  // Too good is as suspicious: points that are not independent but balanced.
  std::vector<double> balanced = uniform_errors(engine, 32, 256, 1);
  for (double& error : balanced) error /= 8;
  CHECK(contradicts_variance(test_mc_variance(balanced, 256, 1.0 / 12, -1.2), 100));
}

TEST_CASE("the test does not apply where its law does not hold", "[unit][estimate]") {
  const std::vector<double> errors(4, 0.1);
  CHECK_FALSE(test_mc_variance(errors, 64, 1.0, 6.4).applicable);
  CHECK(test_mc_variance(errors, 64, 1.0, 6.3).applicable);
  CHECK(test_mc_variance(errors, 64, 1.0, std::nullopt).applicable);
  CHECK_FALSE(test_mc_variance(errors, 64, 0.0, 0.0).applicable);
  CHECK_FALSE(
      test_mc_variance(errors, 64, std::numeric_limits<double>::infinity(), 0.0).applicable);
  CHECK_FALSE(test_mc_variance({}, 64, 1.0, 0.0).applicable);
  const std::vector<double> bad = {0.1, std::nan("")};
  const McTest test = test_mc_variance(bad, 64, 1.0, 0.0);
  CHECK_FALSE(test.applicable);
  CHECK_FALSE(test.p_value);
  CHECK_FALSE(test.reason.empty());
  CHECK_FALSE(contradicts_variance(test, 1));
}

TEST_CASE("errors far beyond the law contradict it without overflow", "[unit][estimate]") {
  const std::vector<double> errors(4, 1e300);
  const McTest test = test_mc_variance(errors, 64, 1e-300, 0.0);
  CHECK(test.p_value == 0.0);
  CHECK(contradicts_variance(test, 10));
}

}  // namespace koksma
