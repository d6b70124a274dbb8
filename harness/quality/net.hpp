// The net parameter t in base 2, from the points themselves.
#pragma once

#include <optional>
#include <string>

#include "quality/kernels.hpp"

namespace koksma {

// The least t such that every elementary interval of volume 2^(t-m) holds exactly 2^t of the N =
// 2^m points (Niederreiter 1992, definition 4.1); t = m always holds. Empty with a reason where N
// is no power of two or the shapes of intervals are too many.
struct NetParameter {
  std::optional<std::uint32_t> t;
  std::uint32_t m = 0;
  std::string reason;
};
NetParameter net_parameter(QualityKernels& kernels, const PointSet& points);

}  // namespace koksma
