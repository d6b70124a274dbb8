// Constructions of the table family (kernels/points/table.cl): sets of two-dimensional points as
// 64-bit fractions.
#pragma once

#include <cstdint>
#include <vector>

#include "points/tables.hpp"

namespace koksma {

// K points [point][x, y].
using PlanarSet = std::vector<std::uint64_t>;

// The points of a tile: the option "points", a number or the user's text.
std::uint64_t table_size(const Json& options);

// Dart throwing on the unit torus with decreasing radius (McCool & Fiume, Hierarchical Poisson disk
// sampling distributions, Graphics Interface 1992): the first n points are at least
// distance / sqrt(n) apart, for every n <= size. Coordinates of 32 bits.
PlanarSet throw_darts(std::uint64_t seed, std::uint64_t size, double distance);

// Progressive multi-jittered (0,2) points (Christensen, Kensler & Kilpatrick, Progressive
// multi-jittered sample sequences, CGF 37 (2018)): every prefix of 2^k <= size points has one point
// in every elementary interval of area 2^-k. `size` is a power of two.
PlanarSet progressive_multijitter(std::uint64_t seed, std::uint64_t size);

}  // namespace koksma
