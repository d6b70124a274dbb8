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
  const std::vector<double> values = {1, 2, 4, 1, 2, 4, 2};
  for (const Estimator& estimator : load_catalog().estimators) {
    INFO(estimator.name);
    const Estimate estimate = summarise_estimate(estimator, {values, values, 16});
    CHECK(estimate.value == Approx(estimator.interval == "order-statistics" ? 2.0 : 16.0 / 7));
    CHECK(estimate.interval.has_value() == (estimator.interval != "none"));
    if (estimator.moments == 1) {
      CHECK(summarise_estimate(estimator, {values, {}, 16}).interval.has_value() ==
            estimate.interval.has_value());
    }
  }
  CHECK_THROWS_AS(summarise("no-such-interval", {values, values, 16}), std::invalid_argument);
}

TEST_CASE("every kind of interval is there, or a reason why not", "[unit][estimate]") {
  const std::vector<double> estimates = {1, 2, 4, 5, 3, 2};
  const std::vector<double> variances = {1, 1, 2, 1, 1, 1};
  const std::vector<double> bad = {1, std::nan(""), 4};
  for (const std::string_view kind : interval_kinds()) {
    INFO(kind);
    const Estimate full = summarise(kind, {estimates, variances, 16});
    CHECK(full.interval.has_value() == (kind != "none"));
    CHECK(full.standard_error.has_value() ==
          (full.interval.has_value() && kind != "order-statistics"));
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
      CHECK(estimate.standard_error.has_value() == estimate.reason.empty());
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

TEST_CASE("the median's interval is from the ranks of the binomial law, with its exact level",
          "[unit][estimate]") {
  // 1 - 2 P(Bin(15, 1/2) <= 3) = 1 - 2 * 576 / 2^15.
  std::vector<double> estimates;
  for (int i = 15; i > 0; --i) estimates.push_back(i * i);
  const Estimate median = summarise("order-statistics", {estimates, {}, 64});
  CHECK(median.value == 64.0);
  CHECK(median.interval->low == 16.0);
  CHECK(median.interval->high == 144.0);
  CHECK(median.level == Approx(1 - 2 * 576.0 / 32768).epsilon(1e-14));
  // 1 - 2 / 2^5 = 0.9375 is too little, 1 - 2 / 2^6 = 0.96875 is not.
  CHECK_FALSE(summarise("order-statistics", {std::span(estimates).first(5), {}, 64}).interval);
  const Estimate six = summarise("order-statistics", {std::span(estimates).first(6), {}, 64});
  CHECK(six.value == (169 + 144) / 2.0);
  CHECK(six.interval->low == 100.0);
  CHECK(six.interval->high == 225.0);
  CHECK(six.level == 0.96875);
}

TEST_CASE("medians are of consecutive groups, and of none that is not finite", "[unit][estimate]") {
  const std::vector<double> estimates = {5, 1, 3, -2, 8, 0, 7, INFINITY, 7};
  const std::vector<double> medians = group_medians(estimates, 3);
  REQUIRE(medians.size() == 3);
  CHECK(medians[0] == 3.0);
  CHECK(medians[1] == 0.0);
  CHECK_FALSE(std::isfinite(medians[2]));
}

TEST_CASE("variances of pairs are those computed by hand", "[unit][estimate]") {
  // Pairs (1, 3), (2, 10), (4, 4): means 2, 6, 4, whose sample variance is 4, so N Var(Q) = 8;
  // differences -2, -8, 0 with N Var(Q) = sum d^2 / N = 68 / 6.
  const std::vector<double> y = {1, 3, 2, 10, 4, 4};
  ExactSum sum, about_centre, differences;
  const double y0 = 1.5;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double mean = (y[i] + y[i ^ 1]) / 2 - y0, difference = y[i] - y[i ^ 1];
    sum.add(y[i]);
    about_centre.add(mean * mean);
    differences.add(difference * difference);
  }
  const double u = 0x1p-53;
  CHECK(*variance_of_replicate("pair-means", 6, sum, about_centre, y0, u) == Approx(8));
  CHECK(*variance_of_replicate("pair-differences", 6, sum, differences, y0, u) == Approx(68.0 / 6));
  CHECK_FALSE(variance_of_replicate("pair-means", 2, sum, about_centre, y0, u));
  differences.add(INFINITY);
  CHECK_FALSE(variance_of_replicate("pair-differences", 6, sum, differences, y0, u));
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
