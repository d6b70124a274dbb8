// The launch shape of a plan: lanes per work-item, work-group size and blocks per launch, chosen
// from the device's facts, or among shapes that `koksma tune` has timed on it. A shape never
// changes a result: partial sums are the same bits for 4, 8 and 16 lanes and every work-group size
// and launch split (3-kernels 2); width 1 and the others agree only for integrands of exact
// operations, so a tuning crosses that line for no other.
#pragma once

#include <string>
#include <vector>

#include "plan/plan.hpp"

namespace koksma {

// One shape as it was timed with the kernel of one family of points.
struct TimedShape {
  std::string family;  // of points
  Precision precision = Precision::fp64;
  LaunchShape shape;   // log2_block is empty, items_per_launch is not
  double seconds = 0;  // above 0, by the device's clock; of the same work for all of a family
};

// What `koksma tune` measured on one device with one driver.
struct Tuning {
  std::string date;  // ISO 8601, UTC
  std::vector<TimedShape> timed;
};

// What bounds the shapes of a kernel.
struct ShapeNeeds {
  const Sampler* sampler = nullptr;
  const Integrand* integrand = nullptr;  // nullptr: points only, which are never tuned
  std::uint32_t dim = 1;
  Precision precision = Precision::fp64;
  std::uint32_t least_lanes = 1;
};

struct ShapeChoice {
  LaunchShape shape;
  bool tuned = false;
};

// Bound on blocks x replicates of a launch that nothing else sets: 2^13 * 16 partial sums are 1 MiB
// per word, enough items for any device.
inline constexpr std::uint64_t kItemsPerLaunch = std::uint64_t{1} << 13;

// Whether both launch alike, whatever their blocks.
bool same_shape(const LaunchShape& a, const LaunchShape& b);

// The default shape: a CPU runs one wide item per group; a GPU runs the narrowest items, as many
// per group as private memory allows. UnsupportedError where not even the narrowest fits.
LaunchShape default_shape(const DeviceFacts& device, const ShapeNeeds& needs);

// The fastest of the device's timed shapes that the needs allow, if it beats the default shape by
// more than kLeastGain; the default shape otherwise. A family that was not timed takes the
// geometric mean over those that were.
ShapeChoice choose_shape(const DeviceFacts& device, const ShapeNeeds& needs);

// Less is within the noise of timings.
inline constexpr double kLeastGain = 0.05;

}  // namespace koksma
