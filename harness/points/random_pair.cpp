#include <Random123/philox.h>

#include "points/tables.hpp"

namespace koksma {

RandomPair random_pair(std::uint64_t seed, std::uint64_t index, std::uint32_t replicate,
                       RandomPurpose purpose, std::uint32_t dimension) {
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
  const r123::Philox4x32::ctr_type counter{
      {low(index), high(index), replicate, static_cast<std::uint32_t>(purpose) << 24 | dimension}};
  const r123::Philox4x32::key_type key{{low(seed), high(seed)}};
  const auto words = r123::Philox4x32{}(counter, key);
  const auto join = [](std::uint32_t upper, std::uint32_t lower) {
    return std::uint64_t{upper} << 32 | lower;
  };
  return {join(words[0], words[1]), join(words[2], words[3])};
}

}  // namespace koksma
