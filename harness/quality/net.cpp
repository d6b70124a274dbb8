#include "quality/net.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace koksma {
namespace {

constexpr double kMostWork = 0x1p33;  // points times dimensions times shapes
constexpr std::uint64_t kMostCells = std::uint64_t{1} << 24;  // counters of one launch
constexpr std::uint32_t kMostLog2N = 24;

// Calls `take` with every (k_1, ..., k_d) of sum k, until it says false.
bool each_shape(std::vector<std::uint8_t>& shape, std::size_t dimension, std::uint32_t rest,
                const std::function<bool()>& take) {
  if (dimension + 1 == shape.size()) {
    shape[dimension] = static_cast<std::uint8_t>(rest);
    return take();
  }
  for (std::uint32_t k = 0; k <= rest; ++k) {
    shape[dimension] = static_cast<std::uint8_t>(k);
    if (!each_shape(shape, dimension + 1, rest - k, take)) return false;
  }
  return true;
}

// Shapes of sum k in d dimensions: binomial(k + d - 1, k).
double shape_count(std::uint32_t dim, std::uint32_t k) {
  double count = 1;
  for (std::uint32_t i = 1; i <= k; ++i) count *= static_cast<double>(dim - 1 + i) / i;
  return count;
}

// True when all intervals of volume 2^-k hold their share.
bool balanced(QualityKernels& kernels, const cl::Buffer& digits, const PointSet& points,
              std::uint32_t m, std::uint32_t k) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::uint64_t at_once = std::clamp<std::uint64_t>(
      kMostCells >> k, 1, static_cast<std::uint64_t>(std::min(shape_count(points.dim, k), 4096.0)));
  const cl::Buffer counts = kernels.device().allocate((at_once << k) * sizeof(cl_uint));
  std::vector<std::uint8_t> shape(points.dim, 0), batch;
  const auto flush = [&] {
    const auto count = static_cast<std::uint32_t>(batch.size() / points.dim);
    if (count == 0) return true;
    const cl::Buffer out = kernels.device().allocate(count * sizeof(cl_uint));
    kernels.run("net", "balanced_shapes", count, digits, n, points.dim, m, k,
                kernels.device().upload(batch.data(), batch.size()), count, counts, out);
    const std::vector<std::uint32_t> good = kernels.read_words(out, count);
    batch.clear();
    return std::all_of(good.begin(), good.end(), [](std::uint32_t one) { return one == 1; });
  };
  return each_shape(shape, 0, k,
                    [&] {
                      batch.insert(batch.end(), shape.begin(), shape.end());
                      return batch.size() < at_once * points.dim || flush();
                    }) &&
         flush();
}

}  // namespace

NetParameter net_parameter(QualityKernels& kernels, const PointSet& points) {
  NetParameter result;
  if (!std::has_single_bit(points.size())) {
    result.reason = fmt::format("N = {} is no power of two", points.size());
    return result;
  }
  result.m = static_cast<std::uint32_t>(std::countr_zero(points.size()));
  if (result.m > kMostLog2N) {
    result.reason = fmt::format("N = 2^{}: the limit is 2^{}", result.m, kMostLog2N);
    return result;
  }
  std::vector<std::uint32_t> words(points.x.size());
  for (std::uint64_t i = 0; i < points.size(); ++i)
    for (std::uint32_t j = 0; j < points.dim; ++j)
      words[j * points.size() + i] =
          static_cast<std::uint32_t>(std::ldexp(points.at(i, j), static_cast<int>(result.m)));
  const cl::Buffer digits = kernels.upload_words(words);

  // Balance at k implies balance at k - 1, so the first failure decides.
  std::uint32_t k = 0;
  double work = 0;
  while (k < result.m) {
    work += shape_count(points.dim, k + 1) * static_cast<double>(points.x.size());
    if (work > kMostWork) {
      result.reason = fmt::format(
          "t <= {}, and telling whether it is less takes more than 2^33 coordinates", result.m - k);
      return result;
    }
    if (!balanced(kernels, digits, points, result.m, k + 1)) break;
    ++k;
  }
  result.t = result.m - k;
  return result;
}

}  // namespace koksma
