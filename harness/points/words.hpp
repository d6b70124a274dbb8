// What the table builders of several families share.
#pragma once

#include <cstdint>

namespace koksma {

// Bit i becomes bit 63 - i.
inline std::uint64_t reverse_bits(std::uint64_t x) {
  std::uint64_t result = 0;
  for (int i = 0; i < 64; ++i, x >>= 1) result = result << 1 | (x & 1);
  return result;
}

}  // namespace koksma
