// Times of the launches of rows, with launches of the calibration kernel between them. Every timed
// launch has one before and one after it, at most 10 ms of launches away; long launches have
// several. The shortest counts: one that meets another process tells of that and not of the device.
// So calibrating costs about a twentieth of the time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "device/calibration.hpp"
#include "estimate/cell_result.hpp"

namespace koksma {

// Median, minimum and interquartile range of at least one time.
TimeStatistics summarise_times(std::vector<double> times);

// Of launches, from one calibration to the next.
inline constexpr double kSecondsBetweenCalibrations = 0.005;
// At most so many launches of a row that is timed by itself.
inline constexpr std::size_t kLaunchesAlone = 5;

// Whether a row that was launched `count` times in `spent` seconds has enough: 20 ms of launches
// and at least three, as a median needs, unless those take 60 ms; never more than `most`.
bool enough_launches(std::size_t count, double spent, std::size_t most);

class TimedLaunches {
 public:
  explicit TimedLaunches(Calibration& calibration);

  // One launch of this row: seconds of the kernel and of the wall; `merged`: the latter with the
  // merge of its sums, as row.wall counts them.
  void add(Row& row, double kernel_s, double wall_s, bool merged = true);
  // Wall seconds of all launches of the row of this N.
  double spent(std::uint64_t n) const;
  // After the last launch of rows[first], ...: their calibrations and time statistics.
  void finish(std::vector<Row>& rows, std::size_t first);

 private:
  struct Times {
    std::vector<double> wall, calibration;
    double spent = 0;
  };
  void calibrate();

  Calibration& calibration_;
  double before_ = 0, since_ = 0;         // the last calibration; wall seconds since
  std::vector<std::uint64_t> uncovered_;  // N of the launches since
  std::map<std::uint64_t, Times> times_;
};

}  // namespace koksma
