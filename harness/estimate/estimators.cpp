#include "estimate/estimators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>
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

// The largest k with P(X_(k) < median < X_(m+1-k)) = 1 - 2 P(Bin(m, 1/2) < k) >= 95 % for m
// independent values of a continuous law (H. A. David, H. N. Nagaraja, Order Statistics, 3rd ed.
// 2003, section 7.1); m = 15: ranks 4 and 12, 96.48 %. 0: there is none (m < 6).
struct OrderStatistics {
  std::size_t rank = 0;
  double level = 0;
};

OrderStatistics median_ranks(std::size_t size) {
  OrderStatistics best;
  const boost::math::binomial_distribution<> heads(static_cast<double>(size), 0.5);
  for (std::size_t k = 1; 2 * k <= size; ++k) {
    const double level = 1 - 2 * cdf(heads, static_cast<double>(k - 1));
    if (level < 1 - 2 * kIntervalTail) break;
    best = {k, level};
  }
  return best;
}

Estimate summarise_order_statistics(const EstimatorInput& input) {
  Estimate result;
  std::vector<double> sorted(input.estimates.begin(), input.estimates.end());
  if (sorted.empty() ||
      !std::all_of(sorted.begin(), sorted.end(), [](double q) { return std::isfinite(q); })) {
    result.reason = sorted.empty() ? "no replicates" : "a replicate is not finite";
    return result;
  }
  std::sort(sorted.begin(), sorted.end());
  const std::size_t size = sorted.size();
  result.value = std::midpoint(sorted[(size - 1) / 2], sorted[size / 2]);
  const OrderStatistics ranks = median_ranks(size);
  if (ranks.rank == 0) {
    result.reason = "too few randomizations for an interval of the median";
    return result;
  }
  result.interval = Interval{sorted[ranks.rank - 1], sorted[size - ranks.rank]};
  result.level = ranks.level;
  result.reason =
      fmt::format("no standard error: the interval is from order statistics {} and {} of {}",
                  ranks.rank, size + 1 - ranks.rank, size);
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

constexpr std::array<Summary, 4> kSummaries = {{
    {"normal", summarise_normal},
    {"student-t", summarise_student},
    {"order-statistics", summarise_order_statistics},
    {"none", summarise_none},
}};

}  // namespace

Estimate summarise_estimate(const Estimator& estimator, const EstimatorInput& input) {
  for (const Summary& summary : kSummaries) {
    if (summary.interval == estimator.interval) return summary.summarise(input);
  }
  throw std::invalid_argument("no summary for the interval \"" + estimator.interval + "\"");
}

std::optional<double> variance_of_replicate(const std::string& second_moment, std::uint64_t n,
                                            const ExactSum& sum_y, const ExactSum& sum_squares,
                                            double y0, double unit_roundoff) {
  if (second_moment == "values") return sample_variance(n, sum_y, sum_squares, y0, unit_roundoff);
  const auto size = static_cast<double>(n);
  if (second_moment == "pair-differences") {
    if (n < 2 || sum_squares.nonfinite() > 0) return std::nullopt;
    return sum_squares.rounded_quotient(n) / 2;
  }
  // The squares of both lanes of N/2 pairs: their sample variance is that of N values, but for the
  // degrees of freedom, N/2 - 1 instead of N - 1.
  if (n < 4) return std::nullopt;
  const auto variance = sample_variance(n, sum_y, sum_squares, y0, unit_roundoff);
  if (!variance) return std::nullopt;
  return 2 * *variance * (size - 1) / (size - 2);
}

std::vector<double> group_medians(std::span<const double> estimates, std::uint32_t size) {
  std::vector<double> medians;
  for (std::size_t first = 0; first + size <= estimates.size(); first += size) {
    const auto group = estimates.subspan(first, size);
    std::vector<double> values(group.begin(), group.end());
    const bool finite =
        std::all_of(values.begin(), values.end(), [](double q) { return std::isfinite(q); });
    const auto middle = values.begin() + size / 2;
    if (finite) std::nth_element(values.begin(), middle, values.end());
    medians.push_back(finite ? *middle : NAN);
  }
  return medians;
}

std::vector<std::string_view> interval_kinds() {
  std::vector<std::string_view> kinds;
  for (const Summary& summary : kSummaries) kinds.push_back(summary.interval);
  return kinds;
}

}  // namespace koksma
