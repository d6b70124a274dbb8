// Table of the multijitter family (kernels/points/multijitter.cl): the grid and, per pair of
// dimensions, the keys of its order and of the permutations down and across.
#include "points/grids.hpp"
#include "points/tables.hpp"

namespace koksma {

PointTable build_multijitter(const PointRequest& request) {
  const Grid grid = nearest_square(request.end_index);
  PointTable table{{grid.columns, grid.rows}};
  for (std::uint32_t r = 0; r < request.replicates; ++r)
    for (std::uint32_t pair = 0; pair < (request.dim + 1) / 2; ++pair)
      for (const std::uint32_t which : {0U, 1U, 2U})
        append_bijection(table.words, request, r, pair, which);
  return table;
}

}  // namespace koksma
