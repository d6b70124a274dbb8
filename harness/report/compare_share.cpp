#include "report/compare_share.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "estimate/quantile.hpp"

namespace koksma {
namespace {

double median_of(std::vector<double> values) {
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

// Standard deviation of what a calibration differs from the one before it, by the smaller ones:
// others are steps from one speed to another.
double neighbours_apart(const std::vector<Launches>& rows) {
  std::vector<double> apart;
  for (const Launches& row : rows)
    for (std::size_t i = 1; i < row.calibrations.size(); ++i) {
      const double d = std::fabs(row.calibrations[i] - row.calibrations[i - 1]);
      if (d > 0) apart.push_back(d);  // else they share one
    }
  if (apart.empty()) return 0;
  std::sort(apart.begin(), apart.end());
  constexpr double kOfNormal = 3.1384;  // standard deviation over the lower quartile of |x|
  return kOfNormal * quantile_of(apart, 0.25);
}

// Slopes of y over x between all pairs whose x lie further apart than `least`.
struct Slopes {
  std::vector<double> slopes;
  std::size_t pairs = 0;  // all

  bool add(double x_apart, double y_apart, double least) {
    ++pairs;
    if (std::fabs(x_apart) <= least) return false;
    slopes.push_back(y_apart / x_apart);
    return true;
  }
  std::optional<double> share(double least_pairs) && {
    if (slopes.empty() ||
        static_cast<double>(slopes.size()) < least_pairs * static_cast<double>(pairs))
      return {};
    return std::max(median_of(std::move(slopes)), 0.0);
  }
};

// Of the calibrations of a run a fast one, not the fastest, which may be a disturbance.
double fast_calibration(const std::vector<Launches>& rows) {
  std::set<double> distinct;
  for (const Launches& row : rows)
    distinct.insert(row.calibrations.begin(), row.calibrations.end());
  const std::vector<double> sorted(distinct.begin(), distinct.end());
  return quantile_of(sorted, 0.05);
}

}  // namespace

RowShift shift_of(const Launches& base, const Launches& now) {
  return {shift_estimate(base.times, now.times),
          shift_estimate(base.calibrations, now.calibrations)};
}

std::optional<double> share_within(const std::vector<Launches>& rows) {
  const std::vector<Launches> some = thinned(rows);
  const double least = std::max(std::log(kSpeedsDiffer), 4 * neighbours_apart(some));
  Slopes slopes;
  std::set<double> slower, faster;  // launches, and rows, share calibrations
  for (const Launches& row : some)
    for (std::size_t i = 0; i < row.times.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double x = row.calibrations[i], before = row.calibrations[j];
        if (!slopes.add(x - before, row.times[i] - row.times[j], least)) continue;
        slower.insert(std::max(x, before));
        faster.insert(std::min(x, before));
      }
  if (std::min(slower.size(), faster.size()) < kLeastCalibrations) return {};
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

Interval Followed::between(double low) const {
  const double less = (low - share) * clock, more = (std::max(share, 1.0) - share) * clock;
  return {std::min(less, more), std::max(less, more)};
}

Followed what_is_followed(const std::vector<Launches>& base, const std::vector<Launches>& now) {
  std::vector<Launches> runs = base;
  runs.insert(runs.end(), now.begin(), now.end());
  if (const auto within = share_within(runs))
    return {*within, fast_calibration(now) - fast_calibration(base), *within};
  std::vector<RowShift> shifts;
  std::vector<double> clocks;
  for (std::size_t i = 0; i < base.size(); ++i) {
    shifts.push_back(shift_of(base[i], now[i]));
    clocks.push_back(shifts.back().calibration);
  }
  const double clock = median_of(std::move(clocks));
  if (std::fabs(clock) < std::log(kSpeedsDiffer)) return {1, clock, 0};
  const double between = share_between(shifts).value_or(0);
  return {between, clock, between};
}

}  // namespace koksma
