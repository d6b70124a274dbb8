#include "quality/star.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace koksma {
namespace {

// The distinct coordinates of one dimension in ascending order, and 1.
std::vector<double> grid_of(const PointSet& points, std::uint32_t dimension) {
  std::vector<double> grid{1.0};
  for (std::uint64_t i = 0; i < points.size(); ++i) grid.push_back(points.at(i, dimension));
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

// max(vol[0,y) - A([0,y))/N, A([0,y])/N - vol[0,y]) by counting.
double local_discrepancy(const PointSet& points, const std::vector<double>& y) {
  std::uint64_t open = 0, closed = 0;
  for (std::uint64_t i = 0; i < points.size(); ++i) {
    bool below = true, within = true;
    for (std::uint32_t j = 0; j < points.dim; ++j) {
      below = below && points.at(i, j) < y[j];
      within = within && points.at(i, j) <= y[j];
    }
    open += below ? 1 : 0;
    closed += within ? 1 : 0;
  }
  const double volume = std::accumulate(y.begin(), y.end(), 1.0, std::multiplies<>());
  const auto n = static_cast<double>(points.size());
  return std::max(volume - static_cast<double>(open) / n, static_cast<double>(closed) / n - volume);
}

// The points as ranks in their sorted coordinates, as threshold.cl wants them.
struct RankedPoints {
  PointSet ranks;
  std::vector<std::vector<double>> grids;
  std::vector<double> grid_rows;  // [dimension][stride]
  std::vector<std::uint32_t> top;
  std::uint32_t stride = 0;
};

RankedPoints ranked(const PointSet& points) {
  RankedPoints result;
  result.ranks = points;
  for (std::uint32_t j = 0; j < points.dim; ++j) {
    result.grids.push_back(grid_of(points, j));
    const std::vector<double>& grid = result.grids.back();
    result.top.push_back(static_cast<std::uint32_t>(grid.size() - 1));
    result.stride = std::max(result.stride, static_cast<std::uint32_t>(grid.size()));
    for (std::uint64_t i = 0; i < points.size(); ++i)
      result.ranks.x[i * points.dim + j] = static_cast<double>(
          std::lower_bound(grid.begin(), grid.end(), points.at(i, j)) - grid.begin());
  }
  result.grid_rows.assign(std::size_t{result.stride} * points.dim, 1.0);
  for (std::uint32_t j = 0; j < points.dim; ++j)
    std::copy(result.grids[j].begin(), result.grids[j].end(),
              result.grid_rows.begin() + static_cast<std::ptrdiff_t>(j) * result.stride);
  return result;
}

}  // namespace

double star_exact(QualityKernels& kernels, const PointSet& points) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::uint32_t missing = 3 - points.dim;
  std::vector<std::uint64_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::uint64_t a, std::uint64_t b) {
    return points.at(a, points.dim - 1) < points.at(b, points.dim - 1);
  });
  std::vector<std::vector<double>> columns(3, std::vector<double>(n, 0.0)), grids(2, {1.0});
  for (std::uint32_t j = 0; j < points.dim; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) columns[missing + j][i] = points.at(order[i], j);
    if (missing + j < 2) grids[missing + j] = grid_of(points, j);
  }
  const auto size1 = static_cast<std::uint32_t>(grids[0].size());
  grids[1].resize(kernels.padded(grids[1].size()), 1.0);  // the last box again
  const auto blocks2 = static_cast<std::uint32_t>(grids[1].size() / kernels.lanes());
  const std::uint64_t items = std::uint64_t{size1} * blocks2;
  const cl::Buffer out = kernels.scalars(2 * items);
  kernels.run("star", "critical_boxes", items, kernels.upload(columns[0]),
              kernels.upload(columns[1]), kernels.upload(columns[2]), n, kernels.upload(grids[0]),
              size1, kernels.upload(grids[1]), blocks2, out);
  const std::vector<double> excess = kernels.read(out, 2 * items);
  return *std::max_element(excess.begin(), excess.end());
}

double star_search_work(const PointSet& points, const StarSearch& search) {
  // Counting, then two passes per coordinate for snapping.
  const double boxes = std::pow(search.rounds + 1.0, 2) * search.chains;
  return boxes * 3 * static_cast<double>(points.x.size());
}

double star_lower_bound(QualityKernels& kernels, const PointSet& points, const StarSearch& search) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::uint32_t padded = kernels.padded(n);
  const RankedPoints r = ranked(points);
  const double above_every_rank = 1e9;
  const std::uint64_t scratch =
      std::uint64_t{search.chains} * (padded + 3 * points.dim + search.rounds);
  const std::uint64_t coordinates = std::uint64_t{search.chains} * points.dim;
  const cl::Buffer box = kernels.scalars(coordinates);
  kernels.run("threshold", "threshold_accepting", search.chains,
              kernels.columns(r.ranks, above_every_rank), kernels.upload(r.grid_rows),
              kernels.upload_words(r.top), n, padded, points.dim, r.stride, search.chains,
              search.rounds, search.seed, kernels.scalars(scratch), box);
  const std::vector<double> boxes = kernels.read(box, coordinates);
  double best = 0;
  std::vector<double> y(points.dim);
  for (std::uint32_t chain = 0; chain < search.chains; ++chain) {
    for (std::uint32_t j = 0; j < points.dim; ++j)
      y[j] = r.grids[j][static_cast<std::size_t>(boxes[std::size_t{chain} * points.dim + j])];
    best = std::max(best, local_discrepancy(points, y));
  }
  return best;
}

}  // namespace koksma
