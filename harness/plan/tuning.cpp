#include "plan/tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "error/error.hpp"

namespace koksma {
namespace {

// Bound on local size x lanes x dim x sizeof(real) (3-kernels).
constexpr std::uint64_t kPrivateBytes = std::uint64_t{1} << 20;

// What a lane keeps. Families with tables keep a state of D numbers; so do integrands that need all
// coordinates.
std::uint64_t bytes_per_lane(const ShapeNeeds& needs) {
  const std::uint64_t kept =
      (find_table_builder(needs.sampler->family) != nullptr ? 1 : 0) +
      (needs.integrand != nullptr && needs.integrand->all_coordinates ? 1 : 0);
  const std::uint64_t size = needs.precision == Precision::fp64 ? 8 : 4;
  return std::max<std::uint64_t>(kept * std::uint64_t{needs.dim} * size, 1);
}

bool is_allowed(const LaunchShape& shape, const LaunchShape& usual, const DeviceFacts& device,
                const ShapeNeeds& needs) {
  const bool same_bits = needs.integrand->exact_operations ||
                         (shape.lanes_per_item == 1) == (usual.lanes_per_item == 1);
  return same_bits && shape.lanes_per_item >= needs.least_lanes &&
         shape.local_size <= device.max_work_group_size &&
         std::uint64_t{shape.local_size} * shape.lanes_per_item * bytes_per_lane(needs) <=
             kPrivateBytes;
}

// Seconds of both shapes in every family that timed both; the second shape's are the larger ones
// where the first is faster.
double log_gain(const std::vector<const TimedShape*>& timed, const LaunchShape& usual,
                const LaunchShape& shape) {
  std::map<std::string, double> usual_s, shape_s;
  for (const TimedShape* t : timed) {
    if (same_shape(t->shape, usual)) usual_s[t->family] = t->seconds;
    if (same_shape(t->shape, shape)) shape_s[t->family] = t->seconds;
  }
  double sum = 0;
  std::size_t families = 0;
  for (const auto& [family, seconds] : shape_s) {
    const auto found = usual_s.find(family);
    if (found == usual_s.end()) continue;
    sum += std::log(found->second / seconds);
    ++families;
  }
  // A shape that only some families have timed would win by their choice.
  return families == usual_s.size() && families > 0 ? sum / static_cast<double>(families) : 0;
}

}  // namespace

bool same_shape(const LaunchShape& a, const LaunchShape& b) {
  return a.lanes_per_item == b.lanes_per_item && a.local_size == b.local_size &&
         a.items_per_launch.value_or(kItemsPerLaunch) ==
             b.items_per_launch.value_or(kItemsPerLaunch);
}

LaunchShape default_shape(const DeviceFacts& device, const ShapeNeeds& needs) {
  const std::uint64_t lane_bytes = bytes_per_lane(needs), least = needs.least_lanes;
  if (least * lane_bytes > kPrivateBytes)
    throw UnsupportedError(
        fmt::format("d = {} with sampler '{}': a work-item would keep {} bytes, {} are safe",
                    needs.dim, needs.sampler->name, least * lane_bytes, kPrivateBytes));
  const std::uint64_t lanes = kPrivateBytes / lane_bytes;
  if (device.is_cpu)
    return {lanes >= 16  ? 16u
            : lanes >= 8 ? 8u
            : lanes >= 4 ? 4u
                         : 1u,
            1, std::nullopt, std::nullopt};
  const std::uint64_t most =
      std::min<std::uint64_t>({64, device.max_work_group_size, lanes / least});
  return {needs.least_lanes, static_cast<std::uint32_t>(std::bit_floor(most)), std::nullopt,
          std::nullopt};
}

ShapeChoice choose_shape(const DeviceFacts& device, const ShapeNeeds& needs) {
  const LaunchShape usual = default_shape(device, needs);
  if (device.tuning == nullptr || needs.integrand == nullptr) return {usual, false};
  std::vector<const TimedShape*> of_family, of_precision;
  for (const TimedShape& t : device.tuning->timed) {
    if (t.precision != needs.precision) continue;
    of_precision.push_back(&t);
    if (t.family == needs.sampler->family) of_family.push_back(&t);
  }
  const auto& timed = of_family.empty() ? of_precision : of_family;
  ShapeChoice best{usual, false};
  double most = -std::log1p(-kLeastGain);
  for (const TimedShape* t : timed) {
    if (!is_allowed(t->shape, usual, device, needs)) continue;
    const double gain = log_gain(timed, usual, t->shape);
    if (gain <= most) continue;
    most = gain;
    best = {t->shape, true};
  }
  return best;
}

}  // namespace koksma
