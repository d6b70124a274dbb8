// The verdict on a fitted rate: targets, gates, and when a gate does not apply.
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "estimate/convergence.hpp"

namespace koksma {
namespace {

ExpectedRate expected_rate(double constant, double per_dimension, std::uint32_t max_d,
                           double tolerance, bool log_correction) {
  ExpectedRate expected;
  expected.constant = constant;
  expected.per_dimension = per_dimension;
  expected.gate_max_d = max_d;
  expected.gate_tolerance = tolerance;
  expected.log_correction = log_correction;
  return expected;
}

RateFit fitted(double slope, std::size_t replicates = 32) {
  RateFit fit;
  fit.slope = slope;
  fit.replicates = replicates;
  for (unsigned m = 8; m <= 16; ++m) fit.used.push_back(std::uint64_t{1} << m);
  return fit;
}

}  // namespace

TEST_CASE("rates are judged against constant + per_dimension/d within the tolerance",
          "[unit][estimate]") {
  const ExpectedRate smooth = expected_rate(-1.5, 0, 2, 0.15, true);
  CHECK(judge(fitted(-1.5), smooth, 1).verdict == "within-gate");
  CHECK(*judge(fitted(-1.5), smooth, 1).target == -1.5);
  // The correction at d = 2 is 1/(2 ln 2^12) = 0.0601.
  CHECK(*judge(fitted(-1.5), smooth, 2).expected == -1.5);
  CHECK(*judge(fitted(-1.5), smooth, 2).target == Approx(-1.4399).margin(1e-4));
  CHECK(judge(fitted(-1.30), smooth, 2).verdict == "within-gate");
  CHECK(judge(fitted(-1.28), smooth, 2).verdict == "outside-gate");
  CHECK(judge(fitted(-1.58), smooth, 2).verdict == "within-gate");
  CHECK(judge(fitted(-1.60), smooth, 2).verdict == "outside-gate");
  CHECK(judge(fitted(-1.09), smooth, 5).verdict == "reported");

  const ExpectedRate oblique = expected_rate(-0.5, -0.5, 2, 0.15, false);
  CHECK(*judge(fitted(-0.8), oblique, 2).target == -0.75);
  CHECK(judge(fitted(-0.8), oblique, 2).verdict == "within-gate");
  CHECK(judge(fitted(-1.0), oblique, 2).verdict == "outside-gate");
}

TEST_CASE("no gate applies to heavy tails, single runs, few replicates or missing theory",
          "[unit][estimate]") {
  const ExpectedRate smooth = expected_rate(-1.5, 0, 2, 0.15, true);
  RateFit fit = fitted(-0.1);
  CHECK(judge(fit, smooth, 1).verdict == "outside-gate");
  fit.heavy_tailed = true;
  CHECK(judge(fit, smooth, 1).verdict == "reported");
  CHECK(judge(fit, smooth, 1).reason == "heavy-tailed errors");
  fit.heavy_tailed = false;
  fit.deterministic = true;
  CHECK(judge(fit, smooth, 1).verdict == "reported");
  CHECK(judge(fitted(-0.1, 31), smooth, 1).verdict == "reported");
  RateFit short_fit = fitted(-0.1);
  short_fit.used.resize(7);
  CHECK(judge(short_fit, smooth, 1).reason == "fewer than 8 rows");
  // The log factor belongs to the rows that were fitted: over 2^12 … 2^20 its middle is 2^16.
  RateFit far = fitted(-1.45);
  for (std::uint64_t& n : far.used) n <<= 4;
  CHECK(*judge(far, smooth, 2).target == Approx(-1.5 + 1 / (2 * 16 * std::log(2.0))));
  CHECK(judge(fitted(-0.1), ExpectedRate{}, 1).verdict == "reported");
  CHECK_FALSE(judge(fitted(-0.1), ExpectedRate{}, 1).target);
  CHECK(judge(fitted(-0.1), std::nullopt, 1).verdict == "no-theory");

  RateFit none;
  none.reason = "fewer than 6 usable rows";
  const RateVerdict verdict = judge(none, smooth, 1);
  CHECK(verdict.verdict == "no-rate");
  CHECK(verdict.reason == none.reason);
  CHECK(*verdict.expected == -1.5);
  CHECK(judge(none, std::nullopt, 1).verdict == "no-rate");
}

TEST_CASE("a rate may depend on parameters, down to a limit, and its gate on their range",
          "[unit][estimate]") {
  // -(1 - a) - p, never steeper than -1.5; gated for a <= 1/4.
  ExpectedRate rate = expected_rate(-1, 0, 2, 0.25, false);
  rate.per_parameter = {{1, 1.0}, {0, -1.0}};
  rate.at_least = -1.5;
  rate.gate_parameters_at_most = {{1, 0.25}};
  const std::vector<double> mild = {0, 0.25}, wild = {0, 0.3}, steep = {2, 0.25};
  CHECK(expected_slope(rate, mild, 1) == -0.75);
  CHECK(expected_slope(rate, wild, 1) == Approx(-0.7));
  CHECK(expected_slope(rate, steep, 1) == -1.5);
  CHECK(judge(fitted(-0.9), rate_at(rate, mild), 1).verdict == "within-gate");
  CHECK(judge(fitted(-1.1), rate_at(rate, mild), 1).verdict == "outside-gate");
  CHECK(*judge(fitted(-0.9), rate_at(rate, mild), 2).target == -0.75);
  const RateVerdict ungated = judge(fitted(-0.1), rate_at(rate, wild), 1);
  CHECK(ungated.verdict == "reported");
  CHECK(ungated.reason == "no gate");
  CHECK(*judge(fitted(-1.5), rate_at(rate, steep), 1).expected == -1.5);
}

TEST_CASE("a rate may depend on a parameter over the dimension", "[unit][estimate]") {
  // -1 + a / d
  ExpectedRate rate = expected_rate(-1, 0, 8, 0.15, false);
  rate.per_parameter_over_dimension = {{1, 1.0}};
  const std::vector<double> parameters = {7, 2};
  CHECK(expected_slope(rate, parameters, 4) == -0.5);
  CHECK(expected_slope(rate, parameters, 8) == -0.75);
  CHECK(*judge(fitted(-0.5), rate_at(rate, parameters), 4).target == -0.5);
}

}  // namespace koksma
