// How fast the device is just now: the time of a short kernel of fixed work on all its cores
// (kernels/calibrate.cl). Times of two runs are compared as multiples of it, because a machine that
// is shared drifts by more than what a comparison is after.
#pragma once

#include <string>

#include "device/device.hpp"

namespace koksma {

class Calibration {
 public:
  // Builds the kernel and runs it once, so that nothing is compiled later.
  explicit Calibration(Device& device);

  // Launches it once: its seconds by the device's clock, about 2e-4 on a CPU. Launches are counted
  // and their wall time is summed, for the cost of calibrating to be known.
  double run();

  // Tells its kernels apart, by their code and not by comments, as 16 hexadecimal digits: times
  // beside different ones are not to be compared, nor those of different devices.
  static std::string identity(const DeviceFacts& device);

  std::size_t launches() const { return launches_; }
  double wall_s() const { return wall_s_; }

 private:
  Device& device_;
  cl::Kernel kernel_;
  cl::Buffer out_;
  std::size_t items_, local_size_;
  cl_uint salt_ = 0;
  std::size_t launches_ = 0;
  double wall_s_ = 0;
};

}  // namespace koksma
