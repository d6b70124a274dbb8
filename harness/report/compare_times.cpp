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

// Slopes are taken over at most so many rows, evenly chosen: their number goes as the square.
constexpr std::size_t kMostRows = 2048;

template <typename T>
std::vector<T> thinned(const std::vector<T>& rows) {
  const std::size_t step = (rows.size() + kMostRows - 1) / kMostRows;
  std::vector<T> some;
  for (std::size_t i = 0; i < rows.size(); i += step) some.push_back(rows[i]);
  return some;
}

// Standard deviation of what a calibration differs from the one before it, without outliers.
double neighbours_apart(const std::vector<Launches>& rows) {
  std::vector<double> apart;
  for (const Launches& row : rows)
    for (std::size_t i = 1; i < row.calibrations.size(); ++i) {
      const double d = std::fabs(row.calibrations[i] - row.calibrations[i - 1]);
      if (d > 0) apart.push_back(d);  // else they share one
    }
  constexpr double kOfNormal = 1.4826;  // standard deviation over the median deviation
  return apart.empty() ? 0 : kOfNormal * median(std::move(apart));
}

// Slopes of y over x between all pairs whose x lie further apart than `least`.
struct Slopes {
  std::vector<double> slopes;
  std::size_t pairs = 0;  // all

  void add(double x_apart, double y_apart, double least) {
    ++pairs;
    if (std::fabs(x_apart) > least) slopes.push_back(y_apart / x_apart);
  }
  std::optional<double> share(double least_pairs) && {
    if (slopes.empty() ||
        static_cast<double>(slopes.size()) < least_pairs * static_cast<double>(pairs))
      return {};
    return std::max(median(std::move(slopes)), 0.0);
  }
};

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

std::optional<double> share_within(const std::vector<Launches>& rows) {
  const std::vector<Launches> some = thinned(rows);
  const double least = std::max(std::log(kSpeedsDiffer), 4 * neighbours_apart(some));
  Slopes slopes;
  for (const Launches& row : some)
    for (std::size_t i = 0; i < row.times.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        slopes.add(row.calibrations[i] - row.calibrations[j], row.times[i] - row.times[j], least);
  return std::move(slopes).share(kLeastPairs);
}

std::optional<double> share_between(const std::vector<RowShift>& rows) {
  const std::vector<RowShift> some = thinned(rows);
  Slopes slopes;
  for (std::size_t i = 0; i < some.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      slopes.add(some[i].calibration - some[j].calibration, some[i].time - some[j].time,
                 std::log(kSpeedsApart));
  const auto share = std::move(slopes).share(0.1);
  return share && std::fabs(*share - 1) < kFollowsFully ? 1 : share;
}

Stratum less_followed(const Launches& base, const Launches& now, double followed) {
  const auto left = [&](const Launches& run) {
    std::vector<double> logs = run.times;
    for (std::size_t i = 0; i < logs.size(); ++i) logs[i] -= followed * run.calibrations[i];
    return logs;
  };
  return {left(base), left(now)};
}

Stratum followed_by_speed(const Launches& base, const Launches& now,
                          const std::optional<double>& between) {
  const RowShift shift = shift_of(base, now);
  if (std::fabs(shift.calibration) < std::log(kSpeedsApart)) return less_followed(base, now, 1);
  if (between) return less_followed(base, now, *between);
  const double multiple = shift.time - shift.calibration;
  double nearest = 0;
  if (shift.time * multiple > 0)
    nearest = std::fabs(shift.time) < std::fabs(multiple) ? shift.time : multiple;
  Stratum moved{base.times, now.times};
  for (double& time : moved.b) time += nearest - shift.time;
  return moved;
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
