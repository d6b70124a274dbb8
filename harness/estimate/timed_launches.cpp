#include "estimate/timed_launches.hpp"

#include <algorithm>
#include <cmath>

#include "estimate/quantile.hpp"

namespace koksma {
namespace {

constexpr std::size_t kMostAtOnce = 5;
constexpr double kRepeatSeconds = 0.020, kMostSeconds = 0.060;
constexpr std::size_t kLeastLaunches = 3;
constexpr std::size_t kTrials = 3;  // of a launch of several runs

std::uint32_t runs_that_last(double run_s, std::uint32_t room) {
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(kSecondsOfRuns / run_s), 1.0, static_cast<double>(room)));
}

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

std::uint32_t runs_of_launch(Integrator& integrator, std::uint64_t n, double y0, double kernel_s) {
  const std::uint32_t room = integrator.runs_at_once(n);
  if (room < 2 || kernel_s >= kSecondsOfRuns) return 1;
  const std::vector<RepeatedRun> several(kTrials, {n, runs_that_last(kernel_s, room)});
  const std::vector<double> run_s = integrator.times_together(several, y0);
  return runs_that_last(*std::min_element(run_s.begin(), run_s.end()), room);
}

TimedLaunches::TimedLaunches(Calibration& calibration)
    : calibration_(calibration), before_(calibration.run()) {}

void TimedLaunches::add_merged(Row& row, std::optional<double> kernel_s, double wall_s) {
  times_[row.n].wall.push_back(wall_s);
  if (kernel_s)
    add(row, *kernel_s, wall_s);
  else
    pass(wall_s);
}

std::size_t TimedLaunches::merged(std::uint64_t n) const {
  const auto found = times_.find(n);
  return found == times_.end() ? 0 : found->second.wall.size();
}

void TimedLaunches::add(Row& row, double kernel_s, double wall_s) {
  row.kernel_times.push_back(kernel_s);
  times_[row.n].spent += wall_s;
  uncovered_.push_back(row.n);
  pass(wall_s);
}

void TimedLaunches::pass(double wall_s) {
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
