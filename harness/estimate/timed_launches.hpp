// Times of the launches of rows, with launches of the calibration kernel between them. Every timed
// launch has one before and one after it, at most 10 ms of launches away; long launches have
// several, whose median counts. Their geometric mean is the calibration beside a launch, or the
// shorter one where they are further apart than any two speeds of the device: the other met another
// process. So calibrating costs about a twentieth of the time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "device/calibration.hpp"
#include "device/integrator.hpp"
#include "estimate/cell_result.hpp"

namespace koksma {

// Median, minimum and interquartile range of at least one time.
TimeStatistics summarise_times(std::vector<double> times);

// The calibration beside launches, of those before and after them.
double calibration_between(double before, double after);

// Of launches, from one calibration to the next.
inline constexpr double kSecondsBetweenCalibrations = 0.005;
// A cell's launches are made in so many passes, where others' can be made between them: what
// disturbs a shared machine for a second or two meets some of them then and not all
// (results/README.md).
inline constexpr std::size_t kPasses = 4;
// At most so many launches of a row that is timed by itself.
inline constexpr std::size_t kLaunchesAlone = 5;
// So often a row is run, waited for and merged by itself: wall times are those of these runs.
inline constexpr std::size_t kMergedRuns = 5;

// Runs of n samples that a timed launch makes, 1 or more: as few as take kSecondsOfRuns, as far as
// it has room for them. `run_s` is the kernel time of a launch of one run; as its start shows in
// that, launches of several are timed here. 1 where a run leaves compute units idle: runs side by
// side would look faster than any.
std::uint32_t runs_of_launch(Integrator& integrator, std::uint64_t n, double y0, double run_s);

// Whether a row that was launched `count` times in `spent` seconds has enough: 20 ms of launches
// and at least three, as a median needs, unless those take 60 ms; never more than `most`. Of all
// that, `share` in (0, 1] is asked for.
bool enough_launches(std::size_t count, double spent, std::size_t most, double share = 1);

class TimedLaunches {
 public:
  explicit TimedLaunches(Calibration& calibration);

  // One launch of this row: the kernel's seconds of a run, and the wall's of the launch.
  void add(Row& row, double kernel_s, double wall_s);
  // The same of one run that was waited for and its sums merged: row.wall is made of these.
  void add_merged(Row& row, double kernel_s, double wall_s);
  std::size_t merged(std::uint64_t n) const;
  // Whether this is asked for the first time of this N.
  bool chooses_runs(std::uint64_t n) { return !std::exchange(times_[n].runs_are_chosen, true); }
  // The launches of the row so far are not counted as such: those from now on make several runs.
  void restart(Row& row);
  // Wall seconds of all launches of the row of this N.
  double spent(std::uint64_t n) const;
  // Before launches that do not follow the last ones, and after those: nothing else lies between a
  // launch and its calibrations.
  void resume();
  void pause();
  // Calibrations and time statistics of rows[first], ... and their launches so far; paused.
  void finish(std::vector<Row>& rows, std::size_t first) const;

 private:
  struct Times {
    std::vector<double> wall, merged_kernel, calibration;
    double spent = 0;
    bool runs_are_chosen = false;
  };
  void calibrate();

  Calibration& calibration_;
  double before_ = 0, since_ = 0;         // the last calibration; wall seconds since
  std::vector<std::uint64_t> uncovered_;  // N of the launches since
  std::map<std::uint64_t, Times> times_;
};

}  // namespace koksma
