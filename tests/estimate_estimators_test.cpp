// Summaries of replicates: estimate, standard error, interval and its coverage.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "estimate/estimators.hpp"

namespace koksma {
namespace {

Estimator estimator_with(std::string_view interval) {
  Estimator estimator;
  estimator.interval = interval;
  return estimator;
}

Estimate summarise(std::string_view interval, const EstimatorInput& input) {
  return summarise_estimate(estimator_with(interval), input);
}

}  // namespace

TEST_CASE("every estimator of the catalog can be summarised", "[unit][estimate]") {
  const std::vector<double> values = {1, 2, 4};
  for (const Estimator& estimator : load_catalog().estimators) {
    INFO(estimator.name);
    const Estimate estimate = summarise_estimate(estimator, {values, values, 16});
    CHECK(estimate.value == Approx(7.0 / 3));
    CHECK(estimate.interval.has_value() == (estimator.interval != "none"));
    if (estimator.moments == 1) {
      CHECK(summarise_estimate(estimator, {values, {}, 16}).interval.has_value() ==
            estimate.interval.has_value());
    }
  }
  CHECK_THROWS_AS(summarise("no-such-interval", {values, values, 16}), std::invalid_argument);
}

TEST_CASE("every kind of interval is there, or a reason why not", "[unit][estimate]") {
  const std::vector<double> estimates = {1, 2, 4};
  const std::vector<double> variances = {1, 1, 2};
  const std::vector<double> bad = {1, std::nan(""), 4};
  for (const std::string_view kind : interval_kinds()) {
    INFO(kind);
    const Estimate full = summarise(kind, {estimates, variances, 16});
    CHECK(full.interval.has_value() == (kind != "none"));
    CHECK(full.interval.has_value() == full.standard_error.has_value());
    const Estimate one =
        summarise(kind, {std::span(estimates).first(1), std::span(variances).first(1), 16});
    CHECK(one.value == 1.0);
    CHECK(one.interval.has_value() == (kind == "normal"));
    const Estimate none = summarise(kind, {{}, {}, 16});
    CHECK_FALSE(none.value);
    const Estimate silent = summarise(kind, {bad, variances, 16});
    CHECK_FALSE(silent.value);
    CHECK_FALSE(silent.interval);
    for (const Estimate& estimate : {full, one, none, silent}) {
      CHECK(estimate.interval.has_value() == estimate.reason.empty());
    }
  }
  const Estimate unsummed = summarise("normal", {estimates, std::span(variances).first(2), 16});
  CHECK(unsummed.value);
  CHECK_FALSE(unsummed.interval);
  CHECK(unsummed.reason == "no sample variance");
}

TEST_CASE("summaries of a small example are those computed by hand", "[unit][estimate]") {
  const std::vector<double> estimates = {1, 2, 3, 6};
  const std::vector<double> variances = {4, 4, 4, 20};
  // Pooled variance 8 over 4·8 values; z_.975 = 1.959964.
  const Estimate mc = summarise("normal", {estimates, variances, 8});
  CHECK(mc.value == 3.0);
  CHECK(mc.standard_error == Approx(0.5));
  CHECK(mc.interval->low == Approx(3 - 0.979982));
  CHECK(mc.interval->high == Approx(3 + 0.979982));
  // s² = 14/3; t_{3,.975} = 3.182446.
  const Estimate rqmc = summarise("student-t", {estimates, {}, 8});
  CHECK(rqmc.standard_error == Approx(std::sqrt(14.0 / 12)));
  CHECK(rqmc.interval->high == Approx(3 + 3.182446 * std::sqrt(14.0 / 12)));
}

TEST_CASE("constant replicates give intervals of length zero", "[unit][estimate]") {
  const std::vector<double> estimates(5, 0.1);
  const std::vector<double> variances(5, 0.0);
  for (const std::string_view kind : interval_kinds()) {
    const Estimate estimate = summarise(kind, {estimates, variances, 64});
    CHECK(estimate.value == 0.1);
    if (estimate.interval) CHECK(estimate.interval->low == estimate.interval->high);
  }
}

TEST_CASE("mc and rqmc intervals cover the mean of normal data 95 times in 100",
          "[unit][estimate]") {
  std::mt19937_64 engine(21);
  std::normal_distribution<double> normal;
  std::gamma_distribution<double> half_chi_squared(63 / 2.0, 2.0);
  constexpr int kTrials = 10000;
  int mc_covers = 0;
  int rqmc_covers = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    // 8 replicates of 64 standard normal values: means N(0, 1/64), variances χ²_63/63.
    std::vector<double> estimates(8);
    std::vector<double> variances(8);
    for (double& estimate : estimates) estimate = normal(engine) / 8;
    for (double& variance : variances) variance = half_chi_squared(engine) / 63;
    const Estimate mc = summarise("normal", {estimates, variances, 64});
    const Estimate rqmc = summarise("student-t", {estimates, variances, 64});
    mc_covers += mc.interval->low <= 0 && 0 <= mc.interval->high ? 1 : 0;
    rqmc_covers += rqmc.interval->low <= 0 && 0 <= rqmc.interval->high ? 1 : 0;
  }
  // Binomial sd 0.0022: false alarm 1e-8.
  CHECK(mc_covers / double{kTrials} == Approx(0.95).margin(0.0125));
  CHECK(rqmc_covers / double{kTrials} == Approx(0.95).margin(0.0125));
}

}  // namespace koksma
