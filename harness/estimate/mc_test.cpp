#include "estimate/mc_test.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "estimate/statistics.hpp"

namespace koksma {

namespace {

// The error of an N-mean has the excess kurtosis of one value over N.
constexpr double kLargestExcessOfMean = 0.1;

std::string why_inapplicable(std::span<const double> errors, std::uint64_t samples, double variance,
                             std::optional<double> excess_kurtosis) {
  if (errors.empty() || samples == 0) return "no replicates or no samples";
  if (!std::isfinite(variance)) return "the variance is not finite";
  if (!(variance > 0)) return "the variance is zero";
  if (!std::all_of(errors.begin(), errors.end(), [](double e) { return std::isfinite(e); })) {
    return "a replicate is not finite";
  }
  if (excess_kurtosis &&
      !(*excess_kurtosis / static_cast<double>(samples) < kLargestExcessOfMean)) {
    return "excess kurtosis / N is not below 0.1";
  }
  return "";
}

}  // namespace

McTest test_mc_variance(std::span<const double> errors, std::uint64_t samples, double variance,
                        std::optional<double> excess_kurtosis) {
  McTest result;
  result.replicates = errors.size();
  result.reason = why_inapplicable(errors, samples, variance, excess_kurtosis);
  if (!result.reason.empty()) return result;

  const auto size = static_cast<double>(errors.size());
  const double expected = std::sqrt(variance) / std::sqrt(static_cast<double>(samples));
  const double ratio = root_mean_square(errors) / expected;
  const double statistic = size * ratio * ratio;
  result.applicable = true;
  if (!std::isfinite(statistic)) {
    result.p_value = 0;
    return result;
  }
  result.statistic = statistic;
  const boost::math::chi_squared distribution(size);
  const double below = cdf(distribution, statistic);
  const double above = cdf(complement(distribution, statistic));
  result.p_value = std::min(1.0, 2 * std::min(below, above));
  return result;
}

bool contradicts_variance(const McTest& test, std::size_t rows) {
  return test.applicable && test.p_value &&
         *test.p_value < kMcFalseAlarm / static_cast<double>(rows);
}

}  // namespace koksma
