// Table of the padded-net family (kernels/points/padded-net.cl): per replicate the keys of the
// pairs' orders and of the coordinates' nested scrambles.
#include "points/grids.hpp"
#include "points/tables.hpp"

namespace koksma {

PointTable build_padded_net(const PointRequest& request) {
  const std::uint64_t kept = request.fp64 ? ~std::uint64_t{0} : 0xFFFFFFFFU;
  PointTable table;
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    for (std::uint32_t pair = 0; pair < (request.dim + 1) / 2; ++pair)
      append_bijection(table.words, request, r, pair);
    for (std::uint32_t d = 0; d < request.dim; ++d) {
      const RandomPair key = random_pair(request.seed, 0, r, RandomPurpose::nested_scramble, d);
      table.words.push_back(key.first & kept);
      table.words.push_back((key.second | 1) & kept);
    }
  }
  return table;
}

}  // namespace koksma
