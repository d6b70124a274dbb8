#include "estimate/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numeric>
#include <vector>

#include "estimate/bootstrap.hpp"

namespace koksma {

namespace {

// Below this many values a sample kurtosis says nothing about normality.
constexpr std::size_t kFewestForKurtosisTest = 8;
// Normal quantile of a two-sided 1 % test.
constexpr double kNormalityLimit = 2.5758;

// The power of two that brings the largest |value| into [1/2, 1), so that its powers cannot over-
// or underflow.
int scale_exponent(std::span<const double> values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::fabs(value));
  int exponent = 0;
  std::frexp(largest, &exponent);
  return exponent;
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

double exact_mean(std::span<const double> values) {
  ExactSum sum;
  sum.add(values);
  return sum.rounded_quotient(values.size());
}

// Mean of value^power / 2^(power·exponent).
double scaled_moment(std::span<const double> values, int power, int exponent) {
  ExactSum sum;
  for (const double value : values) {
    const double square = std::pow(std::ldexp(value, -exponent), 2);
    sum.add(power == 2 ? square : square * square);
  }
  return sum.rounded_quotient(values.size());
}

// Deviation and kurtosis about the mean.
void describe_spread(std::span<const double> estimates, ErrorStatistics& result) {
  const std::size_t count = estimates.size();
  if (count < 2) return;
  std::vector<double> deviations;
  for (const double estimate : estimates) deviations.push_back(estimate - *result.mean);
  if (!all_finite(deviations)) return;
  const int exponent = scale_exponent(deviations);
  const double second = scaled_moment(deviations, 2, exponent);
  const auto size = static_cast<double>(count);
  result.sd = std::ldexp(std::sqrt(second * size / (size - 1)), exponent);
  if (count >= 4 && second > 0) {
    result.kurtosis = scaled_moment(deviations, 4, exponent) / (second * second);
  }
}

std::optional<Interval> bootstrap_rmse(std::span<const double> errors) {
  const int exponent = scale_exponent(errors);
  std::vector<double> squares;
  for (const double e : errors) squares.push_back(std::pow(std::ldexp(e, -exponent), 2));

  SplitMix64 generator(kBootstrapSeed);
  std::vector<std::uint32_t> counts(errors.size());
  std::vector<double> values;
  for (std::size_t b = 0; b < kBootstrapResamples; ++b) {
    draw_counts(generator, counts);
    double sum = 0;
    for (std::size_t r = 0; r < squares.size(); ++r) sum += counts[r] * squares[r];
    values.push_back(std::ldexp(std::sqrt(sum / static_cast<double>(squares.size())), exponent));
  }
  return percentile_interval(values);
}

// χ²_R holds for normal errors of mean 0: the kurtosis must be normal and the bias within 3
// standard errors.
bool errors_are_normal(const ErrorStatistics& s) {
  const auto size = static_cast<double>(s.replicates);
  const bool centred = !s.sd || std::fabs(*s.bias) <= 3 * *s.sd / std::sqrt(size);
  return centred && (!s.kurtosis || kurtosis_is_normal(*s.kurtosis, s.replicates));
}

void describe_rmse_interval(std::span<const double> errors, ErrorStatistics& result) {
  if (errors.size() < 2 || !(*result.rmse > 0)) return;
  const bool normal = errors_are_normal(result);
  std::optional<Interval> interval;
  if (normal) {
    const Interval factors = rmse_factors(errors.size());
    interval = Interval{*result.rmse * factors.low, *result.rmse * factors.high};
  } else {
    interval = bootstrap_rmse(errors);
  }
  if (!interval || !std::isfinite(interval->high)) return;
  result.rmse_low = interval->low;
  result.rmse_high = interval->high;
  result.rmse_interval_method = normal ? "chi-squared" : "bootstrap";
}

void describe_errors(std::span<const double> errors, ErrorStatistics& result) {
  result.bias = exact_mean(errors);
  result.rmse = root_mean_square(errors);
  result.median_abs = median_abs(errors);
  if (*result.median_abs > 0) {
    const double ratio = *result.rmse / *result.median_abs;
    if (std::isfinite(ratio)) result.rho = ratio;
    result.heavy_tailed = ratio > kHeavyTailRatio && result.replicates >= kFewestForTails;
  } else {
    result.heavy_tailed = *result.rmse > 0 && result.replicates >= kFewestForTails;
  }
  describe_rmse_interval(errors, result);
}

}  // namespace

double root_mean_square(std::span<const double> values) {
  if (values.empty()) return 0;
  const int exponent = scale_exponent(values);
  return std::ldexp(std::sqrt(scaled_moment(values, 2, exponent)), exponent);
}

double median_abs(std::span<const double> values) {
  if (values.empty()) return 0;
  std::vector<double> sizes;
  for (const double value : values) sizes.push_back(std::fabs(value));
  std::sort(sizes.begin(), sizes.end());
  const std::size_t middle = sizes.size() / 2;
  if (sizes.size() % 2 == 1) return sizes[middle];
  return std::midpoint(sizes[middle - 1], sizes[middle]);
}

Interval rmse_factors(std::size_t replicates) {
  const auto size = static_cast<double>(replicates);
  const boost::math::chi_squared distribution(size);
  return {std::sqrt(size / quantile(complement(distribution, kIntervalTail))),
          std::sqrt(size / quantile(distribution, kIntervalTail))};
}

bool kurtosis_is_normal(double kurtosis, std::size_t size) {
  if (size < kFewestForKurtosisTest) return true;
  const auto n = static_cast<double>(size);
  // Mean, variance and skewness of b2 under normality; then the cube-root transformation to a
  // normal variate.
  const double mean = 3 * (n - 1) / (n + 1);
  const double variance = 24 * n * (n - 2) * (n - 3) / ((n + 1) * (n + 1) * (n + 3) * (n + 5));
  const double skewness = 6 * (n * n - 5 * n + 2) / ((n + 7) * (n + 9)) *
                          std::sqrt(6 * (n + 3) * (n + 5) / (n * (n - 2) * (n - 3)));
  const double a = 6 + 8 / skewness * (2 / skewness + std::sqrt(1 + 4 / (skewness * skewness)));
  const double x = (kurtosis - mean) / std::sqrt(variance);
  const double root = std::cbrt((1 - 2 / a) / (1 + x * std::sqrt(2 / (a - 4))));
  const double z = (1 - 2 / (9 * a) - root) / std::sqrt(2 / (9 * a));
  return std::fabs(z) <= kNormalityLimit;
}

ErrorStatistics summarise_errors(std::span<const double> estimates, std::optional<double> exact) {
  ErrorStatistics result;
  result.replicates = estimates.size();
  for (const double estimate : estimates) result.nonfinite += std::isfinite(estimate) ? 0 : 1;
  if (result.nonfinite > 0 || estimates.empty()) return result;
  result.mean = exact_mean(estimates);
  describe_spread(estimates, result);
  if (!exact || !std::isfinite(*exact)) return result;

  std::vector<double> errors;
  for (const double estimate : estimates) errors.push_back(estimate - *exact);
  if (all_finite(errors)) describe_errors(errors, result);
  return result;
}

std::optional<double> sample_variance(std::uint64_t n, const ExactSum& sum_y,
                                      const ExactSum& sum_sq_about_y0, double y0,
                                      double unit_roundoff) {
  if (n < 2) return std::nullopt;
  ExactSum shifted = sum_y;
  ExactSum offset;
  offset.add_product(y0, n);
  shifted.subtract(offset);
  const double mean = shifted.rounded_quotient(n);
  const double second = sum_sq_about_y0.rounded_quotient(n);
  const double difference = second - mean * mean;
  if (!std::isfinite(difference)) return std::nullopt;

  // Shift, square and the steps above are each off by a unit roundoff or so; less than that is not
  // a variance.
  if (difference <= 8 * unit_roundoff * second) return 0.0;
  const auto size = static_cast<double>(n);
  return difference * (size / (size - 1));
}

}  // namespace koksma
