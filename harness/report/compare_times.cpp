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

// Medians of five neighbours, of fewer at the ends.
std::vector<double> running_medians(const std::vector<double>& values) {
  constexpr std::size_t kReach = 2;
  std::vector<double> medians;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t first = i - std::min(i, kReach),
                      end = std::min(i + kReach + 1, values.size());
    medians.push_back(median({values.data() + first, values.data() + end}));
  }
  return medians;
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

RowShift shift_of(const Launches& base, const Launches& now) {
  return {shift_estimate(base.times, now.times),
          shift_estimate(base.calibrations, now.calibrations)};
}

std::optional<double> share_followed(const std::vector<RowShift>& rows) {
  const double least = std::log(kEqualSpeed);
  std::vector<double> slopes;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = rows[i].calibration - rows[j].calibration;
      if (std::fabs(apart) > least) slopes.push_back((rows[i].time - rows[j].time) / apart);
    }
  const std::size_t pairs = rows.size() * (rows.size() - 1) / 2;
  if (slopes.empty() || 10 * slopes.size() < pairs) return {};
  const double slope = median(std::move(slopes));
  return std::fabs(slope - 1) < kFollowsFully ? 1 : std::max(slope, 0.0);
}

Stratum less_followed(const Launches& base, const Launches& now, double followed) {
  const auto left = [&](const Launches& run) {
    std::vector<double> logs = run.times;
    for (std::size_t i = 0; i < logs.size(); ++i) logs[i] -= followed * run.calibrations[i];
    return logs;
  };
  return {left(base), left(now)};
}

Stratum nearest_to_unchanged(const Launches& base, const Launches& now) {
  const RowShift shift = shift_of(base, now);
  const double multiple = shift.time - shift.calibration;
  double nearest = 0;
  if (shift.time * multiple > 0)
    nearest = std::fabs(shift.time) < std::fabs(multiple) ? shift.time : multiple;
  Stratum moved{base.times, now.times};
  for (double& time : moved.b) time += nearest - shift.time;
  return moved;
}

ComparedLaunches at_equal_speed(const Launches& base, const Launches& now) {
  const std::vector<double> base_speeds = running_medians(base.calibrations),
                            new_speeds = running_medians(now.calibrations);
  const double width = std::log(kEqualSpeed);
  std::vector<double> ends = base_speeds;  // that an interval may have
  ends.insert(ends.end(), new_speeds.begin(), new_speeds.end());
  std::pair<std::size_t, std::size_t> most{0, 0};  // of the run that has fewer, of both
  double from = -INFINITY, to = INFINITY;
  for (const double end : ends) {
    const auto within = [&](const std::vector<double>& speeds) {
      return static_cast<std::size_t>(std::count_if(
          speeds.begin(), speeds.end(), [&](double c) { return c >= end - width && c <= end; }));
    };
    const std::size_t a = within(base_speeds), b = within(new_speeds);
    if (kLeastShare * a < base_speeds.size() || kLeastShare * b < new_speeds.size() ||
        std::pair{std::min(a, b), a + b} <= most)
      continue;
    most = {std::min(a, b), a + b};
    from = end - width;
    to = end;
  }
  const auto multiples = [&](const Launches& run, const std::vector<double>& speeds) {
    std::vector<double> logs;
    for (std::size_t i = 0; i < run.times.size(); ++i)
      if (speeds[i] >= from && speeds[i] <= to) logs.push_back(run.times[i] - run.calibrations[i]);
    return logs;
  };
  return {{multiples(base, base_speeds), multiples(now, new_speeds)}, most.first > 0};
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

void decide(TimeChange& time, double threshold, double p_limit, double spread, double dof) {
  if (!(time.ratio > 0)) return;
  time.change = Change::none;
  if (time.p > p_limit) return;
  if (spread > 0) {
    const boost::math::students_t student(dof);
    const double most = spread * boost::math::quantile(boost::math::complement(student, p_limit));
    if (std::fabs(std::log(time.ratio)) < most) return;
  }
  if (time.ratio >= 1 + threshold) time.change = Change::worse;
  if (time.ratio <= 1 / (1 + threshold)) time.change = Change::better;
}

}  // namespace koksma
