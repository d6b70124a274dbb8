// Host-side tables of the point families: direction numbers, scrambles, lattice vectors. A family
// that needs tables has harness/points/<family>.cpp with `PointTable build_<family>(const
// PointRequest&)`; CMake generates the list of builders from the file names (<family> with '-' as
// '_').
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalog/json.hpp"

namespace koksma {

struct PointRequest {
  Json options;  // the sampler entry's `options`
  std::uint32_t dim = 1;
  bool fp64 = true;  // words of 64 bits, else of 32 (returned in the low half)
  // Indices below this are drawn; the table holds no more columns than that needs. Of a set that is
  // not extensible it is N, and each N has a table of its own.
  std::uint64_t end_index = 1;
  std::uint32_t replicates = 1;
  std::uint64_t seed = 0;
  std::string directions_file;  // Joe-Kuo format; empty: built-in direction numbers
  // What the sampler's preparation computed on a device: [point][dimension]; nullptr: it has none,
  // or has not run.
  std::shared_ptr<const std::vector<double>> prepared;
  // Which dimension the k-th coordinate drawn is, a permutation that begins with 0; empty: the
  // k-th. Families whose dimensions are not alike in law obey it.
  std::vector<std::uint32_t> dimension_order;
  // The integrand draws centred coordinates (KOKSMA_CENTRED_DRAWS): a family may prefer other
  // words.
  bool centred_draws = false;
};

// One value per dimension, from `first` on, in the order in which coordinates are drawn.
template <typename T>
std::vector<T> in_draw_order(const PointRequest& request, const std::vector<T>& by_dimension,
                             std::uint32_t first = 0) {
  if (request.dimension_order.empty()) return by_dimension;
  std::vector<T> result;
  for (std::uint32_t k = first; k < request.dim; ++k)
    result.push_back(by_dimension.at(request.dimension_order.at(k) - first));
  return result;
}

// The words that the family's points_seek reads (layout: the head of kernels/points/<family>.cl).
struct PointTable {
  std::vector<std::uint64_t> words;
};

using PointTableBuilder = PointTable (*)(const PointRequest&);

// Kernels unroll their loops over up to so many dimensions (KOKSMA_UNROLLED), and their state can
// live in registers. Loops over them stay rolled on PoCL by itself: worth 27 % at d = 8 in fp32
// (AVX-512, measured 2026-11-22), nothing or a loss from d = 24 on.
inline constexpr std::uint32_t kMostUnrolledDim = 16;

// The builder of a family, nullptr if it draws without tables.
PointTableBuilder find_table_builder(std::string_view family);

// One launch of a preparation: `items` work-items of a kernel; its arguments are the buffers, then
// these ulongs.
struct PreparationLaunch {
  const char* kernel;
  std::uint64_t items;
  std::vector<std::uint64_t> arguments;
};

// What a device is to run, in this order, before the table can be built: the kernels of
// kernels/points/prepare/<piece>.cl. The first buffer (all of them begin as zeros) receives
// points x dim ulongs [point][dimension], fractions of 64 bits, and after them the number of points
// that were made.
struct Preparation {
  std::string piece;
  std::uint64_t points = 0;
  std::uint32_t dim = 0;
  std::vector<std::uint64_t> other_buffers;  // bytes
  std::vector<PreparationLaunch> launches;
};

// A family whose sets are computed on a device, or read from files, has
// harness/points/<family>_preparation.cpp with `std::optional<Preparation>
// prepare_<family>(const PointRequest&)`, called when a cell is planned: InputError where the
// request asks for more than there is.
using PreparationBuilder = std::optional<Preparation> (*)(const PointRequest&);

// nullptr if the family has none.
PreparationBuilder find_preparation_builder(std::string_view family);

// What a draw from the seed's stream is for; part of the Philox counter, so streams never meet
// (6-definitions 6). Purpose 0 is the `random` family on the device.
enum class RandomPurpose : std::uint32_t {
  points = 0,
  digital_shift = 1,
  linear_scramble = 2,
  nested_scramble = 3,
  lattice_shift = 4,
  lattice_vector = 5,
  rotation = 6,
  jitter = 7,             // places inside strata, on the device
  index_permutation = 8,  // keys of bijections on [0, N)
  digit_permutation = 9,  // of the Halton family
  point_set = 10,         // building a table of points
  tile = 11               // shifts and scrambles of its copies
};

struct RandomPair {
  std::uint64_t first, second;
};

// Philox4x32-10 with key `seed` and counter (index low, index high, replicate, purpose << 24 |
// dimension).
RandomPair random_pair(std::uint64_t seed, std::uint64_t index, std::uint32_t replicate,
                       RandomPurpose purpose, std::uint32_t dimension);

}  // namespace koksma
