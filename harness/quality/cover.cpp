// The bracketing cover of star.hpp. E. Thiemard, An algorithm to compute bounds for the star
// discrepancy, J. Complexity 17 (2001) 850-880: a bracket [a, b] whose coordinates from j on still
// begin at 0 is cut at gamma_i = delta b_i, delta chosen so that the last part [gamma, b] has
// exactly the weight that is allowed; the parts below go on with the coordinate that was cut.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "quality/star.hpp"

namespace koksma {
namespace {

double product(const std::vector<double>& v, std::size_t begin, std::size_t end) {
  return std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(begin),
                         v.begin() + static_cast<std::ptrdiff_t>(end), 1.0, std::multiplies<>());
}

// Hands out the brackets one by one, until `take` says false.
class Decomposition {
 public:
  using Take = std::function<bool(const std::vector<double>&, const std::vector<double>&)>;

  Decomposition(double resolution, bool fp64, Take take)
      : resolution_(resolution), fp64_(fp64), take_(std::move(take)) {}

  // Cuts [lower, upper], whose lower corner is 0 from coordinate j on. False when stopped.
  bool cut(std::vector<double> lower, std::vector<double> upper, std::size_t j) {
    const std::size_t dim = upper.size();
    const double volume = product(upper, 0, dim);
    if (volume <= resolution_) return take_(lower, upper);
    const double rest = product(lower, 0, j) * product(upper, j, dim);
    const double delta =
        std::pow((volume - resolution_) / rest, 1.0 / static_cast<double>(dim - j));
    for (std::size_t i = j; i < dim; ++i) {
      const double gamma = rounded(delta * upper[i]);
      std::vector<double> part = upper;
      part[i] = gamma;
      if (!cut(lower, part, i)) return false;
      lower[i] = gamma;
    }
    return take_(lower, upper);
  }

 private:
  // Neighbours must share their faces, so faces are numbers that the device can hold.
  double rounded(double x) const { return fp64_ ? x : static_cast<double>(static_cast<float>(x)); }

  double resolution_;
  bool fp64_;
  Take take_;
};

constexpr std::size_t kBracketsAtOnce = std::size_t{1} << 16;

}  // namespace

// The recursion is d deep and copies d numbers a level, and no cover of so many dimensions is
// affordable.
constexpr std::uint32_t kMostCoverDim = 64;

std::optional<std::uint64_t> cover_size(std::uint32_t dim, double resolution, std::uint64_t most) {
  if (dim > kMostCoverDim) return std::nullopt;
  std::uint64_t count = 0;
  Decomposition cover(resolution, true, [&](const auto&, const auto&) { return ++count <= most; });
  const bool complete = cover.cut(std::vector<double>(dim, 0.0), std::vector<double>(dim, 1.0), 0);
  return complete ? std::optional(count) : std::nullopt;
}

StarCover star_upper_bound(QualityKernels& kernels, const PointSet& points, double resolution) {
  StarCover result;
  result.bound = 0;
  result.resolution = resolution;
  const auto n = static_cast<std::uint32_t>(points.size());
  const cl::Buffer x = kernels.columns(points, 2.0);  // padding lies outside every box
  std::vector<double> batch;
  const auto flush = [&] {
    const auto boxes = static_cast<std::uint32_t>(batch.size() / (std::size_t{2} * points.dim));
    if (boxes == 0) return;
    const cl::Buffer out = kernels.scalars(boxes);
    kernels.run("star", "bracket_bounds", boxes, x, kernels.padded(n), points.dim, n,
                kernels.upload(batch), boxes, out);
    const std::vector<double> bounds = kernels.read(out, boxes);
    result.bound = std::max(result.bound, *std::max_element(bounds.begin(), bounds.end()));
    result.brackets += boxes;
    batch.clear();
  };
  Decomposition cover(resolution, kernels.fp64(), [&](const auto& lower, const auto& upper) {
    batch.insert(batch.end(), lower.begin(), lower.end());
    batch.insert(batch.end(), upper.begin(), upper.end());
    if (batch.size() / (2 * std::size_t{points.dim}) >= kBracketsAtOnce) flush();
    return true;
  });
  cover.cut(std::vector<double>(points.dim, 0.0), std::vector<double>(points.dim, 1.0), 0);
  flush();
  // Volumes are products of d rounded factors, and the quotients round once.
  const double unit = kernels.fp64() ? 0x1p-53 : 0x1p-24;
  result.bound = std::min(1.0, result.bound + (points.dim + 2) * unit);
  return result;
}

}  // namespace koksma
