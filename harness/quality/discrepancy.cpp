#include "quality/discrepancy.hpp"

#include <algorithm>
#include <cmath>

#include "estimate/exact_sum.hpp"

namespace koksma {
namespace {

cl::Buffer weights(QualityKernels& kernels, std::uint64_t n) {
  std::vector<double> values(kernels.padded(n), 0.0);
  std::fill_n(values.begin(), n, 1.0);
  return kernels.upload(values);
}

// Sums of `kinds` rows of a [kind][part] array.
std::vector<double> summed(const std::vector<double>& parts, std::size_t kinds) {
  std::vector<double> sums(kinds);
  const std::size_t length = parts.size() / kinds;
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    ExactSum sum;
    sum.add(std::span(parts).subspan(kind * length, length));
    sums[kind] = sum.rounded();
  }
  return sums;
}

}  // namespace

L2Discrepancies l2_discrepancies(QualityKernels& kernels, const PointSet& points) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::uint32_t padded = kernels.padded(n);
  const cl::Buffer x = kernels.columns(points, 0.0), weight = weights(kernels, n);
  // Parts of vectors at width 16, of points at width 1: never more than there are points.
  const std::uint64_t blocks = padded / kernels.lanes();
  const cl::Buffer single = kernels.scalars(3 * blocks),
                   pairs = kernels.scalars(std::uint64_t{5} * n);
  kernels.run("pairs", "single_sums", blocks, x, weight, padded, points.dim, single);
  kernels.run("pairs", "pair_sums", n, x, weight, padded, points.dim, n, pairs);
  const std::vector<double> one = summed(kernels.read(single, 3 * blocks), 3);
  const std::vector<double> two = summed(kernels.read(pairs, std::uint64_t{5} * n), 5);

  const double d = points.dim, count = n;
  const auto combine = [&](double constant, double factor, double singles, double doubles) {
    return constant - factor * singles / count + doubles / (count * count);
  };
  L2Discrepancies result;
  result.l2star2 = combine(std::pow(3.0, -d), std::pow(2.0, 1 - d), one[0], two[0]);
  result.cd2 = combine(std::pow(13.0 / 12, d), 2, one[1], two[1]);
  result.wd2 = combine(-std::pow(4.0 / 3, d), 0, 0, two[2]);
  result.md2 = combine(std::pow(19.0 / 12, d), 2, one[2], two[3]);
  result.diaphony2 = combine(-1, 0, 0, two[4]);
  return result;
}

double minimum_toroidal_distance(QualityKernels& kernels, const PointSet& points) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const cl::Buffer x = kernels.columns(points, 0.0), weight = weights(kernels, n);
  const cl::Buffer least = kernels.scalars(n);
  kernels.run("pairs", "nearest", n, x, weight, kernels.padded(n), points.dim, n, least);
  const std::vector<double> squares = kernels.read(least, n);
  return std::sqrt(*std::min_element(squares.begin(), squares.end()));
}

}  // namespace koksma
