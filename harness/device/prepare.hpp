// Preparations: point sets that a device computes before a table can be built, kept on disk.
#pragma once

#include <string>

#include "device/cache.hpp"
#include "device/device.hpp"

namespace koksma {

// build_point_table(plan, n), after the plan's preparation where it has one. Its set comes from, in
// this order: the device object, the cache folder, the device itself. The set is the same whatever
// the device, so the cache knows only the kernels' text and the launches with their arguments.
std::vector<std::byte> point_table(Device& device, const Plan& plan, std::uint64_t n = 0);

// The file that keeps the set of a preparation; "" without a cache folder. Its first line is JSON
// (what the set is, and a checksum), the rest [point][dimension] as little-endian doubles. A file
// that is cut short, damaged or not ours is ignored and written anew, under another name first; a
// folder that cannot be written is no failure.
std::string cache_file(const PlannedPreparation& preparation);

}  // namespace koksma
