// Times launch shapes on a device with the kernels that tune.json lists.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "plan/tuning.hpp"

namespace koksma {

// What is tried, read from tune.json.
struct TuningWork {
  struct Kernel {
    std::string scene, sampler;
  };
  std::vector<Kernel> kernels;
  std::uint64_t n = 1;           // of every kernel
  std::uint32_t replicates = 1;  // of every kernel
  std::vector<std::uint32_t> lanes_per_item, local_sizes;
  std::vector<std::uint64_t> items_per_launch;
};
TuningWork tuning_work(const DeviceFacts& device);

// Times every kernel in every precision of the device: first all widths at the default local size,
// then all local sizes at the best width, then all launch bounds at the best of both; shapes of one
// kernel take turns, so that a busy machine slows all alike, and the fastest of the turns counts. A
// shape that the device refuses is left out. `note` is called with what is about to be timed.
// DeviceError or BuildError when not even the default shape runs. The device's own tuning is not
// used.
Tuning tune(Device& device, const Catalog& catalog, const TuningWork& work,
            const std::function<void(const std::string&)>& note = nullptr);

}  // namespace koksma
