// Table of the stratified family (kernels/points/stratified.cl): the grid and the keys of its
// random orders.
#include "points/grids.hpp"
#include "points/tables.hpp"

namespace koksma {

PointTable build_stratified(const PointRequest& request) {
  const bool pairs = request.options.at("grid") == "pairs";
  const std::uint64_t draws = request.options.value("draws", std::uint64_t{1});
  const std::uint32_t side = cube_side(request.end_index / draws, request.dim);
  const Grid grid = pairs ? nearest_square(request.end_index) : Grid{side, side};
  const std::uint32_t grids = pairs ? (request.dim + 1) / 2 : 1;
  PointTable table{{grid.columns, grid.rows}};
  for (std::uint32_t r = 0; r < request.replicates; ++r)
    for (std::uint32_t g = 0; g < grids; ++g) append_bijection(table.words, request, r, g);
  return table;
}

}  // namespace koksma
