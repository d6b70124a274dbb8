// The star discrepancy D* = sup |vol[0,y) - A([0,y)) / N|: exact in few dimensions, bounds above.
#pragma once

#include <optional>

#include "quality/kernels.hpp"

namespace koksma {

// Exact but for rounding, d <= 3, by all critical boxes: O(N), O(N^2), O(N^3) for d = 1, 2, 3. At
// d = 1 this is 1/(2N) + max |x_(i) - (2i - 1)/(2N)| (Niederreiter 1992, theorem 2.6).
double star_exact(QualityKernels& kernels, const PointSet& points);

// A lower bound: the largest local discrepancy that `chains` searches of rounds^2 boxes each find
// by threshold accepting (kernels/quality/threshold.cl), recomputed here from its box.
struct StarSearch {
  std::uint32_t chains = 32, rounds = 64;
  std::uint64_t seed = 1;
};
double star_lower_bound(QualityKernels& kernels, const PointSet& points, const StarSearch& search);

// Scalars that such a search visits, for deciding whether it is affordable.
double star_search_work(const PointSet& points, const StarSearch& search);

// An upper bound by a bracketing cover (Thiemard 2001, J. Complexity 17): brackets [lower, upper]
// with vol(upper) - vol(lower) <= resolution that cover the cube. bound - resolution <= D* <=
// bound.
struct StarCover {
  double bound = 1, resolution = 1;
  std::uint64_t brackets = 0;
};
StarCover star_upper_bound(QualityKernels& kernels, const PointSet& points, double resolution);

// The number of brackets of such a cover, or nothing when there are more than `most`.
std::optional<std::uint64_t> cover_size(std::uint32_t dim, double resolution, std::uint64_t most);

}  // namespace koksma
