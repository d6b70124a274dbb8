// What the stratified families share: sides of grids and keys of random orders.
#pragma once

#include <cstdint>
#include <vector>

#include "points/tables.hpp"

namespace koksma {

// m with m^dim = n, n < 2^52; of another n the m whose power is nearest below.
std::uint32_t cube_side(std::uint64_t n, std::uint32_t dim);

// The grid of n cells, a columns and b rows, that is nearest to a square: a b = n, a <= b.
struct Grid {
  std::uint32_t columns = 1, rows = 1;
};
Grid nearest_square(std::uint64_t n);

// Key and odd step of a bijection (kernels/points/parts/permute.cl); `which` tells those of one
// dimension apart.
void append_bijection(std::vector<std::uint64_t>& words, const PointRequest& request,
                      std::uint32_t replicate, std::uint32_t dimension, std::uint32_t which = 0);

}  // namespace koksma
