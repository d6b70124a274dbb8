// What must happen before a table of points can be built (kernels/points/prepare/), and what only
// the user's files can refuse.
#include <fmt/format.h>

#include <array>
#include <bit>

#include "error/error.hpp"
#include "points/point_file.hpp"
#include "points/table.hpp"

namespace koksma {
namespace {

constexpr std::uint64_t kCandidatesPerItem = 16;  // KOKSMA_CANDIDATES_PER_ITEM of candidates.cl
constexpr std::uint64_t kPhases = 9;
// Darts per empty cell and level. 6 filled each of 192 sets of 256 to 4096 points, 4 failed for one
// (measured 2026-11-24).
constexpr std::uint64_t kTrials = 24;

// Best candidate: per point, candidates are rated side by side, then one item takes the best. The
// grid grows with the set: one to four points per cell.
Preparation best_candidates(const PointRequest& request, std::uint64_t size) {
  const std::uint64_t factor = request.options.at("candidates");
  const std::uint64_t most_groups = (factor * size) / kCandidatesPerItem + 1;
  Preparation work{"candidates", size, 2, {}, {}};
  work.other_buffers = {most_groups * 16, size * 4, size * 4};
  for (std::uint64_t n = 0; n < size; ++n) {
    const std::uint64_t log2_cells = n == 0 ? 0 : (std::bit_width(n) - 1) / 2;
    const bool grows = n > 1 && std::has_single_bit(n) && std::countr_zero(n) % 2 == 0;
    if (grows) work.launches.push_back({"regrid", 1, {n, log2_cells}});
    const std::uint64_t candidates = factor * n + 1;
    const std::uint64_t groups = (candidates + kCandidatesPerItem - 1) / kCandidatesPerItem;
    work.launches.push_back({"rate", groups, {n, candidates, log2_cells, request.seed}});
    work.launches.push_back({"take", 1, {n, groups, log2_cells, request.seed, size}});
  }
  return work;
}

// The phase groups in an order drawn anew for every trial, so that none is always served first.
std::array<std::uint64_t, kPhases> shuffled_phases(std::uint64_t seed, std::uint64_t trial) {
  std::array<std::uint64_t, kPhases> order{0, 1, 2, 3, 4, 5, 6, 7, 8};
  for (std::uint64_t i = kPhases - 1; i > 0; --i) {
    const std::uint64_t random =
        random_pair(seed, trial << 8 | i, 0, RandomPurpose::point_set, 2).first;
    std::swap(order[i], order[(random >> 32) * (i + 1) >> 32]);
  }
  return order;
}

// Parallel Poisson disks: grids of 15 2^k cells a side, the finest of 15/8 sqrt(size), where the
// distance sqrt(2) / G leaves room for a good deal more points than `size`.
Preparation phase_groups(const PointRequest& request, std::uint64_t size) {
  std::uint64_t finest = 15;
  while (finest * finest * 64 < size * 225) finest *= 2;
  Preparation work{"phase-groups", size, 2, {2 * finest * finest * 16}, {}};
  std::uint64_t step = 0, at = 0;
  for (std::uint64_t grid = 15; grid <= finest; grid *= 2) {
    if (grid > 15) {
      const std::uint64_t other = at == 0 ? 2 * finest * finest : 0;
      work.launches.push_back({"refine", grid * grid, {grid, at, other}});
      at = other;
    }
    // 2^65 / G^2, the square of sqrt(2) / G in units of 2^-32.
    const std::uint64_t squared = ~std::uint64_t{0} / (grid * grid) * 2;
    for (std::uint64_t trial = 0; trial < kTrials; ++trial)
      for (const std::uint64_t phase : shuffled_phases(request.seed, step))
        work.launches.push_back(
            {"throw_darts", grid * grid / 9, {grid, at, phase, ++step, squared, request.seed}});
  }
  work.launches.push_back({"collect", finest * finest, {finest, at, size}});
  return work;
}

// A file holds what it holds.
void check_file(const PointRequest& request) {
  const std::string path = request.options.at("path");
  const PointFile file = read_point_file(path);
  if (request.dim > file.columns)
    throw InputError(path, fmt::format("{} columns", file.columns),
                     fmt::format("{} dimensions are drawn", request.dim));
  if (request.end_index > file.rows)
    throw InputError(path, fmt::format("{} rows", file.rows),
                     fmt::format("{} points are drawn: at most one per row", request.end_index));
}

}  // namespace

std::optional<Preparation> prepare_table(const PointRequest& request) {
  const std::string construction = request.options.at("construction");
  if (construction == "rows") check_file(request);
  if (construction == "candidates") return best_candidates(request, table_size(request.options));
  if (construction == "phase-groups") return phase_groups(request, table_size(request.options));
  return std::nullopt;
}

}  // namespace koksma
