#include "report/compare_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "estimate/quantile.hpp"

namespace koksma {
namespace {

Stratum exchanged(const Stratum& s) { return {s.b, s.a}; }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile_of(values, 0.5);
}

}  // namespace

std::string why_not_timed(const Json& base_cell, const Json& new_cell) {
  for (const char* key : {"replicates", "launches"}) {
    const Json was = base_cell.value(key, Json()), is = new_cell.value(key, Json());
    const auto text = [](const Json& count) { return count.is_null() ? "as usual" : count.dump(); };
    if (was != is) return fmt::format("{}: {}, were {}", key, text(is), text(was));
  }
  return "";
}

Launches launches_of(const Json& row, bool calibrated) {
  Launches launches;
  if (!row.contains("kernel_times_s")) return launches;
  const Json& times = row["kernel_times_s"];
  if (calibrated && row["calibration_s"].size() != times.size()) return launches;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double unit = calibrated ? row["calibration_s"][i].get<double>() : 1;
    const double time = times[i].get<double>();
    if (!(time > 0 && unit > 0)) return {};
    launches.times.push_back(std::log(time));
    launches.calibrations.push_back(std::log(unit));
  }
  return launches;
}

Stratum less_followed(const Launches& base, const Launches& now, double share) {
  const auto left = [share](const Launches& run) {
    std::vector<double> logs = run.times;
    for (std::size_t i = 0; i < logs.size(); ++i) logs[i] -= share * run.calibrations[i];
    return logs;
  };
  return {left(base), left(now)};
}

TimeChange time_change(const Stratum& row) {
  TimeChange result;
  const double shift = shift_estimate(row.a, row.b);
  result.ratio = std::exp(shift);
  result.p = shift >= 0 ? mann_whitney(row.a, row.b).p : mann_whitney(row.b, row.a).p;
  return result;
}

TimeChange combined_change(const std::vector<Stratum>& rows) {
  TimeChange result;
  if (rows.empty()) {
    result.reason = "no row has times to compare";
    return result;
  }
  std::vector<double> shifts;
  std::vector<Stratum> other_way;
  for (const Stratum& row : rows) {
    shifts.push_back(shift_estimate(row.a, row.b));
    other_way.push_back(exchanged(row));
  }
  const double shift = median(shifts);
  result.ratio = std::exp(shift);
  result.p = van_elteren(shift >= 0 ? rows : other_way);
  return result;
}

double spread_of(const std::vector<double>& ratios) {
  if (ratios.size() < kLeastForSpread) return 0;
  std::vector<double> logs;
  for (const double ratio : ratios) logs.push_back(std::log(ratio));
  std::sort(logs.begin(), logs.end());
  constexpr double kLow = 0.05, kHigh = 0.4;
  const auto n = static_cast<double>(logs.size());
  // What a sample quantile of n normal variables is on average: quantile_of's p lies at place
  // p (n - 1), counted from 0.
  const auto expected = [n](double p) {
    return boost::math::quantile(boost::math::normal(), (p * (n - 1) + 0.625) / (n + 0.25));
  };
  return (quantile_of(logs, kHigh) - quantile_of(logs, kLow)) / (expected(kHigh) - expected(kLow));
}

void decide(TimeChange& time, double threshold, double p_limit, double spread, double dof,
            const Interval& explained) {
  if (!(time.ratio > 0)) return;
  time.change = Change::none;
  if (time.p > p_limit) return;
  double most = std::log1p(threshold);
  if (spread > 0) {
    const boost::math::students_t student(dof);
    most =
        std::max(most, spread * boost::math::quantile(boost::math::complement(student, p_limit)));
  }
  const double change = std::log(time.ratio),
               left = change - std::clamp(change, explained.low, explained.high);
  if (std::fabs(change) < most) return;
  if (left == 0 || std::fabs(left) < most)
    time.change = Change::undecided;
  else
    time.change = left > 0 ? Change::worse : Change::better;
}

}  // namespace koksma
