// Table of the latin family (kernels/points/latin.cl): the keys of its permutations.
#include "points/grids.hpp"
#include "points/tables.hpp"

namespace koksma {

PointTable build_latin(const PointRequest& request) {
  PointTable table;
  for (std::uint32_t r = 0; r < request.replicates; ++r)
    for (std::uint32_t d = 0; d < request.dim; ++d) append_bijection(table.words, request, r, d);
  return table;
}

}  // namespace koksma
