// Tables of the table family (kernels/points/table.cl): sets that are computed here, on a device
// beforehand, or read from a file.
#include "points/table.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <stdexcept>

#include "catalog/lanes.hpp"
#include "points/point_file.hpp"
#include "points/words.hpp"

namespace koksma {
namespace {

std::uint64_t fraction_of(double x) {
  return static_cast<std::uint64_t>(std::ldexp(x, 52)) << 12;  // rounded down to the grid
}

// [point][dimension] of some columns; K is rounded up to whole groups of lanes.
struct Columns {
  std::uint64_t size = 0, padded = 0;
  std::uint32_t dim = 0;
  std::vector<std::uint64_t> values;  // [dimension][padded]
};

Columns columns_of(std::uint64_t size, std::uint32_t dim,
                   const std::function<std::uint64_t(std::uint64_t, std::uint32_t)>& value) {
  Columns result{size, (size + kLanes - 1) / kLanes * kLanes, dim, {}};
  result.values.resize(result.padded * dim);
  for (std::uint32_t d = 0; d < dim; ++d)
    for (std::uint64_t i = 0; i < size; ++i) result.values[d * result.padded + i] = value(i, d);
  return result;
}

Columns planar(const PlanarSet& set) {
  return columns_of(set.size() / 2, 2,
                    [&](std::uint64_t i, std::uint32_t d) { return set[2 * i + d]; });
}

Columns rows_of_file(const PointRequest& request) {
  const PointFile file = read_point_file(request.options.at("path"));
  std::vector<std::uint32_t> columns(request.dim);
  std::iota(columns.begin(), columns.end(), 0U);
  const std::vector<std::uint32_t> order = in_draw_order(request, columns);
  return columns_of(file.rows, request.dim, [&](std::uint64_t i, std::uint32_t d) {
    return fraction_of(file.values[i * file.columns + order[d]]);
  });
}

Columns prepared(const PointRequest& request) {
  if (request.prepared == nullptr)
    throw std::logic_error("the table of a prepared set was asked for before its preparation ran");
  const std::vector<double>& points = *request.prepared;
  return columns_of(points.size() / 2, 2, [&](std::uint64_t i, std::uint32_t d) {
    return fraction_of(points[2 * i + d]);
  });
}

Columns build(const PointRequest& request) {
  const std::string construction = request.options.at("construction");
  if (construction == "rows") return rows_of_file(request);
  // The catalog's limit, kept before; more columns than there are must never be read.
  if (request.dim > 2 && !request.options.value("reversed", false))
    throw std::logic_error("a set of two dimensions was asked for more");
  if (construction == "darts")
    return planar(throw_darts(request.seed, table_size(request.options),
                              request.options.at("minimum_distance")));
  if (construction == "doubling")
    return planar(progressive_multijitter(request.seed, table_size(request.options)));
  return prepared(request);
}

}  // namespace

std::uint64_t table_size(const Json& options) {
  const Json& points = options.at("points");
  return points.is_string() ? std::stoull(points.get<std::string>()) : points.get<std::uint64_t>();
}

PointTable build_table(const PointRequest& request) {
  const Columns columns = build(request);
  const bool reversed = request.options.value("reversed", false);
  PointTable table;
  table.words.reserve(1 + columns.values.size());
  table.words.push_back(columns.padded);
  for (const std::uint64_t fraction : columns.values) {
    const std::uint64_t word = reversed ? reverse_bits(fraction) : fraction;
    table.words.push_back(request.fp64 ? word : reversed ? word & 0xFFFFFFFFu : word >> 32);
  }
  return table;
}

}  // namespace koksma
