#include "estimate/efficiency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace koksma {

namespace {

bool usable(double value) { return std::isfinite(value) && value > 0; }

std::optional<double> if_finite(double value) {
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

// The minimum of Σ (1 − overhead u − per_sample v)² over overhead, per_sample ≥ 0, u = 1/T and
// v = N/T > 0. Where the free minimum has a negative member, the convex sum is least with that
// member at 0.
TimeLine least_squares(std::span<const Timing> rows, double largest_n) {
  double u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  for (const Timing& row : rows) {
    const double a = 1 / row.seconds;
    const double b = static_cast<double>(row.n) / largest_n / row.seconds;
    u += a;
    v += b;
    uu += a * a;
    uv += a * b;
    vv += b * b;
  }
  TimeLine line;
  const double determinant = uu * vv - uv * uv;
  const double overhead = u * vv - v * uv;
  const double slope = v * uu - u * uv;
  const bool one_size = !(determinant > 1e-12 * uu * vv);
  if (one_size || overhead <= 0)
    line.per_sample = v / vv / largest_n;
  else if (slope <= 0)
    line.overhead = u / uu;
  else
    line = {overhead / determinant, slope / determinant / largest_n};
  return line;
}

void extrapolate(const ErrorLine& line, double log2_n, ToTolerance& result) {
  const double below = std::log2(static_cast<double>(line.from)) - log2_n;
  const double above = log2_n - std::log2(static_cast<double>(line.to));
  result.octaves_beyond = std::max({below, above, 0.0});
  // A row's own error may come back a rounding beside its N.
  if (result.octaves_beyond < 1e-9) result.octaves_beyond = 0;
  result.extrapolated = result.octaves_beyond > 0;
}

// Why the line is not followed to where it reaches the error.
std::string why_not(const CurveFacts& curve, double error) {
  if (!usable(error)) return "the tolerance is not positive";
  if (!curve.errors) return fmt::format("no fitted line: {}", curve.no_errors);
  if (!(curve.errors->slope < 0)) return "the fitted error does not fall with N";
  if (error < curve.level)
    return fmt::format("{:.2g} is below {:.2g}, {}", error, curve.level, curve.level_is);
  return "";
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

std::optional<TimeLine> fit_times(std::span<const Timing> rows) {
  std::vector<Timing> used;
  double largest_n = 0;
  for (const Timing& row : rows) {
    if (!usable(row.seconds) || row.n == 0) continue;
    used.push_back(row);
    largest_n = std::max(largest_n, static_cast<double>(row.n));
  }
  if (used.empty()) return std::nullopt;
  TimeLine line = least_squares(used, largest_n);
  line.rows = used.size();
  for (const Timing& row : used) {
    const double deviation =
        std::fabs(row.seconds / seconds_at(line, static_cast<double>(row.n)) - 1);
    line.largest_deviation = std::max(line.largest_deviation, deviation);
  }
  return line;
}

double seconds_at(const TimeLine& line, double n) { return line.overhead + line.per_sample * n; }

double samples_in(const TimeLine& line, double seconds) {
  return seconds > line.overhead ? (seconds - line.overhead) / line.per_sample : 0;
}

double error_at(const ErrorLine& line, double n) {
  return std::exp2(line.intercept + line.slope * std::log2(n));
}

ToTolerance to_tolerance(const CurveFacts& curve, double error) {
  ToTolerance result;
  result.reason = why_not(curve, error);
  if (!result.reason.empty()) return result;
  const double log2_n = (std::log2(error) - curve.errors->intercept) / curve.errors->slope;
  if (!(log2_n >= 0)) {
    result.reason = "the fitted line is below it at N = 1";
    return result;
  }
  if (curve.most_n > 0 && log2_n > std::log2(static_cast<double>(curve.most_n))) {
    result.reason = fmt::format("reached at N = 2^{:.1f}, beyond the sampler's 2^{:.4g}", log2_n,
                                std::log2(static_cast<double>(curve.most_n)));
    return result;
  }
  if (!std::isfinite(std::exp2(log2_n))) {
    result.reason = "reached at no finite N";
    return result;
  }
  result.n = std::exp2(log2_n);
  extrapolate(*curve.errors, log2_n, result);
  if (curve.times) result.seconds = if_finite(seconds_at(*curve.times, *result.n));
  if (!result.seconds) result.reason = "no row has a kernel time";
  return result;
}

std::optional<std::uint64_t> crossover(std::span<const BesideRandom> rows) {
  std::vector<BesideRandom> sorted(rows.begin(), rows.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const BesideRandom& a, const BesideRandom& b) { return a.n > b.n; });
  std::optional<std::uint64_t> from;
  for (const BesideRandom& row : sorted) {
    if (!(row.error < row.random_error)) break;
    from = row.n;
  }
  return from;
}

}  // namespace koksma
