#include "plan/untuned_shape.hpp"

#include <algorithm>

namespace koksma {

LaunchShape untuned_shape(const DeviceFacts& device) {
  LaunchShape shape;
  shape.lanes_per_item = device.is_cpu ? 16 : 1;
  shape.local_size =
      device.is_cpu
          ? 1
          : static_cast<std::uint32_t>(std::min<std::uint64_t>(64, device.max_work_group_size));
  return shape;
}

}  // namespace koksma
