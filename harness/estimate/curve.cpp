#include "estimate/curve.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace koksma {

namespace {

// A sample kurtosis of some 32 errors is itself noisy: unclipped, one row could take all or none of
// the weight. A centred uniform variate has 1.8; 12 is what a row needs to count an eleventh of the
// least noisy ones.
constexpr double kLeastKurtosis = 2;
constexpr double kLargestKurtosis = 12;

// Weighted least squares about the weighted mean.
Line weighted_line(std::span<const double> x, std::span<const double> y,
                   std::span<const double> weights) {
  double weight = 0;
  double mean_x = 0;
  double mean_y = 0;
  for (std::size_t m = 0; m < x.size(); ++m) {
    weight += weights[m];
    mean_x += weights[m] * x[m];
    mean_y += weights[m] * y[m];
  }
  mean_x /= weight;
  mean_y /= weight;
  double covariance = 0;
  double variance = 0;
  for (std::size_t m = 0; m < x.size(); ++m) {
    covariance += weights[m] * (x[m] - mean_x) * (y[m] - mean_y);
    variance += weights[m] * (x[m] - mean_x) * (x[m] - mean_x);
  }
  const double slope = covariance / variance;
  return {slope, mean_y - slope * mean_x};
}

// The median of one row's resampled |e|, scaled: the mean of the middle two for even R.
double resampled_median(const Curve& curve, std::size_t row,
                        std::span<const std::uint32_t> counts) {
  const std::size_t size = curve.replicates;
  const std::size_t low_rank = (size - 1) / 2;
  const std::size_t high_rank = size / 2;
  double low = 0;
  bool have_low = false;
  std::size_t seen = 0;
  for (std::size_t i = row * size; i < (row + 1) * size; ++i) {
    seen += counts[curve.ranked[i]];
    if (!have_low && seen > low_rank) {
      low = curve.ranked_abs[i];
      have_low = true;
    }
    if (seen > high_rank) return std::midpoint(low, curve.ranked_abs[i]);
  }
  return 0;
}

}  // namespace

Curve make_curve(const std::vector<const ConvergenceRow*>& rows) {
  Curve curve;
  curve.rows = rows.size();
  curve.replicates = rows.front()->errors.size();
  curve.squares.resize(curve.rows * curve.replicates);
  for (std::size_t m = 0; m < curve.rows; ++m) {
    // Scale by a power of two, which is exact.
    std::vector<double> sizes;
    for (const double e : rows[m]->errors) sizes.push_back(std::fabs(e));
    int exponent = 0;
    std::frexp(*std::max_element(sizes.begin(), sizes.end()), &exponent);
    for (double& size : sizes) size = std::ldexp(size, -exponent);
    curve.log2_samples.push_back(std::log2(static_cast<double>(rows[m]->samples)));
    curve.exponents.push_back(exponent);

    std::vector<std::uint32_t> order(curve.replicates);
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sizes[a] < sizes[b]; });
    for (const std::uint32_t r : order) {
      curve.squares[r * curve.rows + m] = sizes[r] * sizes[r];
      curve.ranked.push_back(r);
      curve.ranked_abs.push_back(sizes[r]);
    }
  }
  return curve;
}

std::optional<Line> rmse_line(const Curve& curve, std::span<const std::uint32_t> counts) {
  // Sums of e² and e⁴ of all rows in one pass over the replicates.
  std::vector<double> second(curve.rows);
  std::vector<double> fourth(curve.rows);
  for (std::size_t r = 0; r < curve.replicates; ++r) {
    const double times = counts[r];
    for (std::size_t m = 0; m < curve.rows; ++m) {
      const double square = curve.squares[r * curve.rows + m];
      second[m] += times * square;
      fourth[m] += times * square * square;
    }
  }

  // Constant factors of the variance cancel in a slope.
  const auto size = static_cast<double>(curve.replicates);
  std::vector<double> y(curve.rows);
  std::vector<double> weights(curve.rows, 1.0);
  for (std::size_t m = 0; m < curve.rows; ++m) {
    if (!(second[m] > 0)) return std::nullopt;
    y[m] = curve.exponents[m] + std::log2(second[m] / size) / 2;
    const double kurtosis = size * fourth[m] / (second[m] * second[m]);
    if (curve.replicates > 1) {
      weights[m] = 1 / (std::clamp(kurtosis, kLeastKurtosis, kLargestKurtosis) - 1);
    }
  }
  return weighted_line(curve.log2_samples, y, weights);
}

std::optional<double> rmse_slope(const Curve& curve, std::span<const std::uint32_t> counts) {
  const std::optional<Line> line = rmse_line(curve, counts);
  return line ? std::optional(line->slope) : std::nullopt;
}

std::optional<double> median_slope(const Curve& curve, std::span<const std::uint32_t> counts) {
  std::vector<double> y(curve.rows);
  for (std::size_t m = 0; m < curve.rows; ++m) {
    const double median = resampled_median(curve, m, counts);
    if (!(median > 0)) return std::nullopt;
    y[m] = curve.exponents[m] + std::log2(median);
  }
  const std::vector<double> weights(curve.rows, 1.0);
  return weighted_line(curve.log2_samples, y, weights).slope;
}

}  // namespace koksma
