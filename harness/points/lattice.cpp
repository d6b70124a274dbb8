// Tables of the lattice family (kernels/points/lattice.cl): generating vectors and shifts in fixed
// point.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "catalog/embedded.hpp"
#include "error/error.hpp"
#include "points/tables.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kHeader = 8;
constexpr std::uint32_t kLanes = 16;

std::vector<std::uint64_t> read_vector(const std::string& name, std::uint32_t dim) {
  const std::string path = fmt::format("kernels/points/vectors/{}.json", name);
  const Json entry = parse_json(embedded_text(path), path);
  check_schema(entry, "harness/catalog/vectors.schema.json", path);
  const auto z = entry["z"].get<std::vector<std::uint64_t>>();
  if (z.size() < dim)
    throw InputError(path, fmt::format("{} components", z.size()),
                     fmt::format("{} are drawn", dim));
  return {z.begin(), z.begin() + dim};
}

// phi_2(gray) z mod 1 as a 64-bit fraction: bit k of gray weighs 2^-(k+1).
std::uint64_t contribution(std::uint64_t z, std::uint32_t k) { return z << (63 - k); }

std::uint64_t kept(std::uint64_t fraction, bool fp64) {
  return fp64 ? fraction >> 12 : fraction >> 32;
}

// Steps of bit 4 + c, for "goes" and "comes", for lanes 0-7 and 8-15: bit 3 is l_3 ^ i_4, and i_4
// turns 1 exactly when c = 0.
std::uint64_t step_of(std::uint64_t z, std::uint32_t c, bool comes, bool upper_half) {
  const bool bit3_comes = upper_half != (c == 0);
  const std::uint64_t high = contribution(z, 4 + c), low = contribution(z, 3);
  return (comes ? high : -high) + (bit3_comes ? low : -low);
}

std::uint64_t lane_point(std::uint64_t z, std::uint32_t lane, bool odd) {
  const std::uint32_t gray = (lane ^ lane >> 1) ^ (odd ? 8u : 0u);
  std::uint64_t point = 0;
  for (std::uint32_t k = 0; k < 4; ++k)
    if ((gray >> k & 1) != 0) point += contribution(z, k);
  return point;
}

}  // namespace

PointTable build_lattice(const PointRequest& request) {
  const std::vector<std::uint64_t> z = read_vector(request.options.at("vector"), request.dim);
  const bool shifted = request.options.at("randomize") == "shift";
  const std::uint32_t columns =
      std::max(static_cast<std::uint32_t>(std::bit_width(request.end_index - 1)), 4u);

  PointTable table;
  std::vector<std::uint64_t>& words = table.words;
  words.resize(kHeader);
  const auto push = [&](std::uint64_t fraction) { words.push_back(kept(fraction, request.fp64)); };
  for (std::uint32_t k = 0; k < columns; ++k)
    for (const std::uint64_t component : z) push(contribution(component, k));
  const std::uint64_t steps = words.size();
  for (std::uint32_t c = 0; c + 4 < columns; ++c)
    for (const bool comes : {false, true})
      for (const bool upper_half : {false, true})
        for (const std::uint64_t component : z) push(step_of(component, c, comes, upper_half));
  const std::uint64_t lanes = words.size();
  for (const bool odd : {false, true})
    for (const std::uint64_t component : z)
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) push(lane_point(component, lane, odd));
  const std::uint64_t starts = words.size();
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    for (std::uint32_t d = 0; d < request.dim; ++d) {
      const std::uint64_t shift =
          shifted ? random_pair(request.seed, 0, r, RandomPurpose::lattice_shift, d).first : 0;
      // fp32: 23 bits in the top of a signed word, offset so that the signed conversion is centred
      // on 1/2.
      words.push_back(request.fp64 ? shift >> 12
                                   : ((shift >> 32) & ~std::uint64_t{511}) ^ 0x80000000u);
    }
  }
  const std::uint64_t header[kHeader] = {request.dim, kHeader, steps, lanes, starts, 0, 0, 0};
  std::copy(std::begin(header), std::end(header), words.begin());
  return table;
}

}  // namespace koksma
