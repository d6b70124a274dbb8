#include "estimate/efficiency.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace koksma {

namespace {

constexpr double kLongestExtrapolation = 1;  // octaves of time

bool usable(double value) { return std::isfinite(value) && value > 0; }

std::optional<double> if_finite(double value) {
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

struct LogPoint {
  double time;   // log2 seconds
  double error;  // log2 rmse
};

std::vector<LogPoint> logarithms(std::span<const TimePoint> rows) {
  std::vector<LogPoint> points;
  for (const TimePoint& row : rows) {
    if (usable(row.seconds) && usable(row.rmse)) {
      points.push_back({std::log2(row.seconds), std::log2(row.rmse)});
    }
  }
  std::sort(points.begin(), points.end(), [](const LogPoint& a, const LogPoint& b) {
    return a.time != b.time ? a.time < b.time : a.error > b.error;
  });
  return points;
}

// Where the line through two points reaches `error`; none if it does not fall.
std::optional<double> crossing(const LogPoint& from, const LogPoint& to, double error) {
  if (!(to.error < from.error)) return std::nullopt;
  return from.time + (to.time - from.time) * (error - from.error) / (to.error - from.error);
}

TimeToTolerance extrapolate(const LogPoint& from, const LogPoint& to, double error, double edge) {
  const std::optional<double> time = crossing(from, to, error);
  if (!time) return {std::nullopt, false, "the error does not fall at the end of the rows"};
  if (std::fabs(*time - edge) > kLongestExtrapolation) {
    return {std::nullopt, false, "more than one octave of time beyond the rows"};
  }
  return {std::exp2(*time), true, ""};
}

}  // namespace

std::optional<double> efficiency(double rmse, double seconds) {
  if (!usable(rmse) || !usable(seconds)) return std::nullopt;
  return if_finite(1 / rmse / rmse / seconds);
}

std::optional<double> variance_reduction(double variance, std::uint64_t samples, double rmse) {
  if (!usable(variance) || samples == 0 || !usable(rmse)) return std::nullopt;
  const double ratio = std::sqrt(variance) / std::sqrt(static_cast<double>(samples)) / rmse;
  return if_finite(ratio * ratio);
}

TimeToTolerance time_to_tolerance(std::span<const TimePoint> rows, double tolerance) {
  if (!usable(tolerance)) return {std::nullopt, false, "the tolerance is not positive"};
  const std::vector<LogPoint> points = logarithms(rows);
  if (points.size() < 2) return {std::nullopt, false, "fewer than two usable rows"};
  const double error = std::log2(tolerance);

  // The last row above the tolerance decides: before it a lucky row may dip below.
  std::size_t above = points.size();
  while (above > 0 && points[above - 1].error <= error) --above;
  if (above == 0) {
    if (points[0].error == error) return {std::exp2(points[0].time), false, ""};
    return extrapolate(points[0], points[1], error, points[0].time);
  }
  if (above == points.size()) {
    const LogPoint& last = points.back();
    return extrapolate(points[points.size() - 2], last, error, last.time);
  }
  return {std::exp2(*crossing(points[above - 1], points[above], error)), false, ""};
}

std::optional<double> speed_up(const TimePoint& monte_carlo, const TimePoint& other) {
  if (!usable(monte_carlo.rmse) || !usable(monte_carlo.seconds)) return std::nullopt;
  if (!usable(other.rmse) || !usable(other.seconds)) return std::nullopt;
  const double ratio = monte_carlo.rmse / other.rmse;
  return if_finite(ratio * ratio * (monte_carlo.seconds / other.seconds));
}

}  // namespace koksma
