// The launch shape of kernels that are not tuned: quality measures and the calibration.
#pragma once

#include "plan/plan.hpp"

namespace koksma {

// As the integration kernels: wide items on a CPU, many scalar ones on a GPU.
LaunchShape untuned_shape(const DeviceFacts& device);

}  // namespace koksma
