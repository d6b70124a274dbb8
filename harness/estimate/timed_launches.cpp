#include "estimate/timed_launches.hpp"

#include <algorithm>
#include <cmath>

#include "estimate/quantile.hpp"

namespace koksma {
namespace {

constexpr std::size_t kMostAtOnce = 5;
constexpr double kRepeatSeconds = 0.020, kMostSeconds = 0.060;
constexpr std::size_t kLeastLaunches = 3;
constexpr double kSpeeds = 2;       // more than from any speed of a shared core to another
constexpr std::size_t kTrials = 3;  // of a launch of several runs

std::uint32_t runs_that_last(double run_s, std::uint32_t room) {
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(kSecondsOfRuns / run_s), 1.0, static_cast<double>(room)));
}

}  // namespace

double calibration_between(double before, double after) {
  const double shorter = std::min(before, after), longer = std::max(before, after);
  return longer > kSpeeds * shorter ? shorter : std::sqrt(before * after);
}

TimeStatistics summarise_times(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return {quantile_of(times, 0.5), times.front(),
          quantile_of(times, 0.75) - quantile_of(times, 0.25), times.size()};
}

bool enough_launches(std::size_t count, double spent, std::size_t most, double share) {
  const auto at_least = [&](std::size_t launches) {
    return static_cast<double>(count) >= share * static_cast<double>(launches);
  };
  return at_least(most) || spent >= share * kMostSeconds ||
         (spent >= share * kRepeatSeconds && at_least(kLeastLaunches));
}

std::uint32_t runs_of_launch(Integrator& integrator, std::uint64_t n, double y0, double run_s) {
  const std::uint32_t room = integrator.runs_at_once(n);
  if (room < 2 || run_s >= kSecondsOfRuns || !integrator.fills_device(n)) return 1;
  std::uint32_t runs = 1, wanted = runs_that_last(run_s, room);
  while (wanted > runs + runs / 4) {
    runs = wanted;
    const std::vector<RepeatedRun> several(kTrials, {n, runs});
    const std::vector<double> times = integrator.times_together(several, y0);
    wanted = runs_that_last(*std::min_element(times.begin(), times.end()), room);
  }
  return runs;
}

TimedLaunches::TimedLaunches(Calibration& calibration)
    : calibration_(calibration), before_(calibration.run()) {}

void TimedLaunches::add(Row& row, double kernel_s, double wall_s) {
  row.kernel_times.push_back(kernel_s);
  times_[row.n].spent += wall_s;
  uncovered_.push_back(row.n);
  since_ += wall_s;
  if (since_ >= kSecondsBetweenCalibrations) calibrate();
}

void TimedLaunches::add_merged(Row& row, double kernel_s, double wall_s) {
  times_[row.n].wall.push_back(wall_s);
  times_[row.n].merged_kernel.push_back(kernel_s);
  add(row, kernel_s, wall_s);
}

std::size_t TimedLaunches::merged(std::uint64_t n) const {
  const auto found = times_.find(n);
  return found == times_.end() ? 0 : found->second.wall.size();
}

void TimedLaunches::restart(Row& row) {
  row.kernel_times.clear();
  times_[row.n].calibration.clear();
  times_[row.n].spent = 0;
  std::erase(uncovered_, row.n);
}

double TimedLaunches::spent(std::uint64_t n) const {
  const auto found = times_.find(n);
  return found == times_.end() ? 0 : found->second.spent;
}

void TimedLaunches::calibrate() {
  const auto count = static_cast<std::size_t>(
      std::clamp(since_ / kSecondsBetweenCalibrations, 1.0, static_cast<double>(kMostAtOnce)));
  std::vector<double> launches;
  for (std::size_t k = 0; k < count; ++k) launches.push_back(calibration_.run());
  std::sort(launches.begin(), launches.end());
  const double after = quantile_of(launches, 0.5);
  for (const std::uint64_t n : uncovered_)
    times_[n].calibration.push_back(calibration_between(before_, after));
  uncovered_.clear();
  before_ = after;
  since_ = 0;
}

void TimedLaunches::resume() { before_ = calibration_.run(); }

void TimedLaunches::pause() {
  if (!uncovered_.empty()) calibrate();
}

void TimedLaunches::finish(std::vector<Row>& rows, std::size_t first) const {
  for (std::size_t i = first; i < rows.size(); ++i) {
    const Times& times = times_.at(rows[i].n);
    rows[i].kernel = summarise_times(rows[i].kernel_times);
    rows[i].wall = summarise_times(times.wall);
    rows[i].merged_kernel_s = summarise_times(times.merged_kernel).median;
    rows[i].calibration = times.calibration;
  }
}

}  // namespace koksma
