#pragma once

#include <cstdint>

namespace koksma {

// The lanes that a block's samples are dealt to, whatever the vector width: accumulators of a block
// (kernels/README.md).
inline constexpr std::uint32_t kLanes = 16;

}  // namespace koksma
