#include "report/compare_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace koksma {
namespace {

// Half the width of a 95 % interval of a normal variable, in standard deviations.
constexpr double kHalfWidth95 = 1.959963984540054;

std::optional<double> number(const Json& value) {
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

// Logarithms of an interval whose ends are positive numbers.
struct LogInterval {
  double low = 0, high = 0;
};
std::optional<LogInterval> log_interval(const Json& interval) {
  if (!interval.is_array() || !interval[0].is_number() || !interval[1].is_number())
    return std::nullopt;
  const double low = interval[0].get<double>(), high = interval[1].get<double>();
  if (!(low > 0 && high >= low)) return std::nullopt;
  return LogInterval{std::log(low), std::log(high)};
}

void by_intervals(const LogInterval& base, const LogInterval& now, double z_limit,
                  ErrorChange& result) {
  result.change = Change::none;
  const bool above = now.low > base.high, below = now.high < base.low;
  if (!above && !below) return;
  const double sd = std::hypot(base.high - base.low, now.high - now.low) / (2 * kHalfWidth95);
  const double distance = std::fabs(std::log(*result.now) - std::log(*result.base));
  if (distance < z_limit * sd) {
    result.suspect = above;
    return;
  }
  result.change = above ? Change::worse : Change::better;
  result.reason = "confidence intervals do not overlap";
}

void up_to_rounding(double floor, double scale, ErrorChange& result) {
  const double allowed = floor + 4 * std::numeric_limits<double>::epsilon() * scale;
  const double growth = *result.now - *result.base;
  result.change = growth > allowed    ? Change::worse
                  : growth < -allowed ? Change::better
                                      : Change::none;
  if (result.change != Change::none)
    result.reason = fmt::format("no randomization: differs by more than rounding, {:.1e}", allowed);
}

}  // namespace

double common_floor(const Json& base_cell, const Json& now_cell) {
  return std::max(number(base_cell["rounding_floor"]).value_or(0),
                  number(now_cell["rounding_floor"]).value_or(0));
}

ErrorChange error_change(const Json& base, const Json& now, double floor, double z_limit) {
  ErrorChange result;
  result.base = number(base["rmse"]);
  result.now = number(now["rmse"]);
  const double scale = std::fabs(number(base["estimate"]).value_or(0));
  if (!result.base) {
    result.reason = "the base has no error";
  } else if (!result.now) {
    result.change = Change::worse;
    const std::string why = now["error_reason"];
    result.reason = fmt::format("there is no error any more{}{}", why.empty() ? "" : ": ", why);
  } else if (now["nonfinite"].get<std::uint64_t>() > base["nonfinite"].get<std::uint64_t>()) {
    result.change = Change::worse;
    result.reason =
        fmt::format("{} samples are not finite, {} were", now["nonfinite"].get<std::uint64_t>(),
                    base["nonfinite"].get<std::uint64_t>());
  } else if (*result.now == *result.base) {
    result.change = Change::none;
  } else if (const auto a = log_interval(base["rmse_interval"]),
             b = log_interval(now["rmse_interval"]);
             a && b) {
    by_intervals(*a, *b, z_limit, result);
  } else if (base["rmse_interval_method"].get<std::string>().empty() &&
             now["rmse_interval_method"].get<std::string>().empty()) {
    up_to_rounding(floor, scale, result);
  } else {
    result.reason = "there is no interval of the error";
  }
  return result;
}

}  // namespace koksma
