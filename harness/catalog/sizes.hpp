// Which N a point set comes in. The forms are the values of /n/form in kernels/points/*.json:
//   any · even: 2 m · power-of-two: 2^m · power-of-d: m^d · twice-power-of-d: 2 m^d · rectangle: a
//   b with a <= b <= 2 a
#pragma once

#include <cstdint>
#include <optional>

#include "catalog/catalog.hpp"

namespace koksma {

// True when the sampler has a set of n >= 1 points in `dim` dimensions; the largest N is not looked
// at.
bool admits(const Sampler& sampler, std::uint32_t dim, std::uint64_t n);

// The largest admitted size <= n and the smallest >= n, within the sampler's largest.
struct NearestSizes {
  std::optional<std::uint64_t> below, above;
};
NearestSizes nearest_sizes(const Sampler& sampler, std::uint32_t dim, std::uint64_t n);

}  // namespace koksma
