#include "estimate/estimators.hpp"

#include <array>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <stdexcept>

#include "estimate/exact_sum.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

namespace {

// The mean of the replicates alone; the part that all estimators here share.
Estimate mean_of_replicates(const EstimatorInput& input) {
  Estimate result;
  const ErrorStatistics s = summarise_errors(input.estimates, std::nullopt);
  result.value = s.mean;
  if (s.replicates == 0) result.reason = "no replicates";
  if (s.nonfinite > 0) result.reason = "a replicate is not finite";
  return result;
}

void set_interval(Estimate& estimate, double standard_error, double factor) {
  const Interval interval{*estimate.value - factor * standard_error,
                          *estimate.value + factor * standard_error};
  if (!std::isfinite(interval.low) || !std::isfinite(interval.high)) {
    estimate.reason = "the standard error exceeds the range of double";
    return;
  }
  estimate.standard_error = standard_error;
  estimate.interval = interval;
}

// Independent samples: all N·R values are one sample, whose variance is pooled over the replicates.
// The central limit theorem gives the interval (P. Glasserman, Monte Carlo Methods in Financial
// Engineering, 2003, eq. 1.2).
Estimate summarise_normal(const EstimatorInput& input) {
  Estimate result = mean_of_replicates(input);
  if (!result.value) return result;
  if (input.variances.size() != input.estimates.size()) {
    result.reason = "no sample variance";
    return result;
  }
  ExactSum sum;
  sum.add(input.variances);
  const double variance = sum.rounded_quotient(input.variances.size());
  if (!std::isfinite(variance) || variance < 0) {
    result.reason = "the sample variance is not finite";
    return result;
  }
  const auto samples =
      static_cast<double>(input.samples) * static_cast<double>(input.estimates.size());
  const boost::math::normal distribution;
  set_interval(result, std::sqrt(variance / samples),
               quantile(complement(distribution, kIntervalTail)));
  return result;
}

// Independent unbiased randomizations: Student t with R − 1 degrees of freedom (P. L'Ecuyer, M.
// Nakayama, A. Owen, B. Tuffin, Confidence intervals for randomized quasi-Monte Carlo estimators,
// WSC 2023).
Estimate summarise_student(const EstimatorInput& input) {
  Estimate result = mean_of_replicates(input);
  if (!result.value) return result;
  const ErrorStatistics s = summarise_errors(input.estimates, std::nullopt);
  if (!s.sd) {
    result.reason = s.replicates < 2 ? "one replicate has no deviation"
                                     : "the deviation exceeds the range of double";
    return result;
  }
  const auto size = static_cast<double>(s.replicates);
  const boost::math::students_t distribution(size - 1);
  set_interval(result, *s.sd / std::sqrt(size), quantile(complement(distribution, kIntervalTail)));
  return result;
}

Estimate summarise_none(const EstimatorInput& input) {
  Estimate result = mean_of_replicates(input);
  if (result.value) result.reason = "this estimator has no interval";
  return result;
}

struct Summary {
  std::string_view interval;
  Estimate (*summarise)(const EstimatorInput& input);
};

constexpr std::array<Summary, 3> kSummaries = {{
    {"normal", summarise_normal},
    {"student-t", summarise_student},
    {"none", summarise_none},
}};

}  // namespace

Estimate summarise_estimate(const Estimator& estimator, const EstimatorInput& input) {
  for (const Summary& summary : kSummaries) {
    if (summary.interval == estimator.interval) return summary.summarise(input);
  }
  throw std::invalid_argument("no summary for the interval \"" + estimator.interval + "\"");
}

std::vector<std::string_view> interval_kinds() {
  std::vector<std::string_view> kinds;
  for (const Summary& summary : kSummaries) kinds.push_back(summary.interval);
  return kinds;
}

}  // namespace koksma
