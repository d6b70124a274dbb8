// The coordinates of points, as the kernels draw them.
#pragma once

#include <cstdint>
#include <vector>

#include "device/device.hpp"

namespace koksma {

class PointsDump {
 public:
  // `plan` comes from make_points_plan.
  PointsDump(Device& device, const Plan& plan);

  // Points start … start+count-1 of one replicate, [point][dimension]; n is the size of the set
  // they belong to (and as the plan's end_index where the set is not extensible). log2_block >= 4:
  // a work-item seeks once and steps through 2^log2_block / 16 samples.
  std::vector<double> read(std::uint64_t start, std::uint64_t count, std::uint64_t n,
                           std::uint32_t replicate, std::uint32_t log2_block = 8);

 private:
  Device& device_;
  const Plan& plan_;
  cl::Kernel kernel_;
  cl::Buffer table_;
};

}  // namespace koksma
