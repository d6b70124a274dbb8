// Verdict on a fitted rate; declared in convergence.hpp.
#include <algorithm>
#include <cmath>
#include <string>

#include "estimate/convergence.hpp"

namespace koksma {

namespace {

// ln N̄, the mean of ln N over the used rows: the log factor changes over the rows (for 2^8 … 2^16,
// on which the gates were measured, ln 2^12; page 5, section 1.9).
double mean_log_samples(const RateFit& rate) {
  if (rate.used.empty()) return 12 * std::log(2.0);
  double sum = 0;
  for (const std::uint64_t n : rate.used) sum += std::log(static_cast<double>(n));
  return sum / static_cast<double>(rate.used.size());
}

// Why a gate does not apply to this fit; empty if it does.
std::string why_not_gated(const RateFit& rate, const ExpectedRate& expected, unsigned d) {
  if (!expected.gate_max_d) return "no gate";
  if (d > *expected.gate_max_d) return "the dimension is above the gate";
  if (rate.deterministic) return "deterministic: no interval";
  if (rate.heavy_tailed) return "heavy-tailed errors";
  if (rate.replicates < kGateReplicates) return "fewer than 32 replicates";
  if (rate.used.size() < kGateRows) return "fewer than 8 rows";
  return "";
}

}  // namespace

ExpectedRate rate_at(ExpectedRate rate, std::span<const double> parameters) {
  for (const ParameterValue& factor : rate.per_parameter)
    rate.constant += factor.value * parameters[factor.parameter];
  rate.per_parameter.clear();
  for (const ParameterValue& factor : rate.per_parameter_over_dimension)
    rate.per_dimension += factor.value * parameters[factor.parameter];
  rate.per_parameter_over_dimension.clear();
  for (const ParameterValue& bound : rate.gate_parameters_at_most)
    if (!(parameters[bound.parameter] <= bound.value)) rate.gate_max_d.reset();
  rate.gate_parameters_at_most.clear();
  return rate;
}

double expected_slope(const ExpectedRate& rate, std::span<const double> parameters, unsigned d) {
  const ExpectedRate here = rate_at(rate, parameters);
  return std::max(here.constant + here.per_dimension / d, here.at_least.value_or(-INFINITY));
}

RateVerdict judge(const RateFit& rate, const std::optional<ExpectedRate>& expected, unsigned d) {
  RateVerdict result;
  if (expected) {
    result.expected = expected_slope(*expected, {}, d);
    if (expected->gate_max_d) {
      const double correction =
          expected->log_correction ? (d - 1) / (2 * mean_log_samples(rate)) : 0;
      result.target = expected->gate_at_most.value_or(*result.expected + correction);
    }
  }
  if (!rate.slope && rate.median_slope) {
    result.verdict = expected ? "reported" : "no-theory";
    result.reason = rate.reason;
    return result;
  }
  if (!rate.slope) {
    result.verdict = "no-rate";
    result.reason = rate.reason;
    return result;
  }
  if (!expected) {
    result.verdict = "no-theory";
    return result;
  }
  result.reason = why_not_gated(rate, *expected, d);
  if (!result.reason.empty()) {
    result.verdict = "reported";
    return result;
  }
  const bool within = expected->gate_at_most
                          ? *rate.slope <= *result.target
                          : std::fabs(*rate.slope - *result.target) <= expected->gate_tolerance;
  result.verdict = within ? "within-gate" : "outside-gate";
  return result;
}

}  // namespace koksma
