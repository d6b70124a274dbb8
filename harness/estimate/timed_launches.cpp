#include "estimate/timed_launches.hpp"

#include <algorithm>

#include "estimate/quantile.hpp"

namespace koksma {
namespace {

constexpr std::size_t kMostAtOnce = 5;
constexpr double kRepeatSeconds = 0.020, kMostSeconds = 0.060;
constexpr std::size_t kLeastLaunches = 3;

}  // namespace

TimeStatistics summarise_times(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return {quantile_of(times, 0.5), times.front(),
          quantile_of(times, 0.75) - quantile_of(times, 0.25), times.size()};
}

bool enough_launches(std::size_t count, double spent, std::size_t most) {
  return count >= most || spent >= kMostSeconds ||
         (spent >= kRepeatSeconds && count >= kLeastLaunches);
}

TimedLaunches::TimedLaunches(Calibration& calibration)
    : calibration_(calibration), before_(calibration.run()) {}

void TimedLaunches::add(Row& row, double kernel_s, double wall_s, bool merged) {
  row.kernel_times.push_back(kernel_s);
  Times& times = times_[row.n];
  if (merged) times.wall.push_back(wall_s);
  times.spent += wall_s;
  uncovered_.push_back(row.n);
  since_ += wall_s;
  if (since_ >= kSecondsBetweenCalibrations) calibrate();
}

double TimedLaunches::spent(std::uint64_t n) const {
  const auto found = times_.find(n);
  return found == times_.end() ? 0 : found->second.spent;
}

void TimedLaunches::calibrate() {
  const auto count = static_cast<std::size_t>(
      std::clamp(since_ / kSecondsBetweenCalibrations, 1.0, static_cast<double>(kMostAtOnce)));
  // The least: a launch that meets another process tells of that, not of the device's speed.
  double after = calibration_.run();
  for (std::size_t k = 1; k < count; ++k) after = std::min(after, calibration_.run());
  for (const std::uint64_t n : uncovered_)
    times_[n].calibration.push_back(std::min(before_, after));
  uncovered_.clear();
  before_ = after;
  since_ = 0;
}

void TimedLaunches::finish(std::vector<Row>& rows, std::size_t first) {
  if (!uncovered_.empty()) calibrate();
  for (std::size_t i = first; i < rows.size(); ++i) {
    rows[i].kernel = summarise_times(rows[i].kernel_times);
    rows[i].wall = summarise_times(times_[rows[i].n].wall);
    rows[i].calibration = times_[rows[i].n].calibration;
  }
}

}  // namespace koksma
