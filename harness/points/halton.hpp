// Radical inverses in prime bases (kernels/points/halton.cl): how a base's digits are cut into
// tables, and the tables of nested scrambling.
#pragma once

#include <cstdint>
#include <vector>

#include "points/tables.hpp"

namespace koksma {

// The first `count` primes.
std::vector<std::uint32_t> first_primes(std::uint32_t count);

// A uniform number below `bound` > 0, without bias (Lemire, ACM TOMACS 29 (2019)): draw(attempt)
// gives 64 random bits.
template <typename Draw>
std::uint32_t uniform_below(std::uint32_t bound, const Draw& draw) {
  for (std::uint32_t attempt = 0;; ++attempt) {
    const unsigned __int128 product = static_cast<unsigned __int128>(draw(attempt)) * bound;
    if (static_cast<std::uint64_t>(product) >= (-std::uint64_t{bound}) % bound)
      return static_cast<std::uint32_t>(product >> 64);
  }
}

// B = base^digits.
struct BasePower {
  std::uint32_t size = 1, digits = 0;
};

// Appends halton's table of nested scrambling (layout: kernels/points/halton.cl) to `words`.
void append_nested_tables(std::vector<std::uint64_t>& words, const PointRequest& request,
                          const std::vector<std::uint32_t>& bases);

}  // namespace koksma
