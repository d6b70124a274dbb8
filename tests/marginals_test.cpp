// Over replicates, every point of a randomized sampler is uniform, and replicates know nothing of
// each other.
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr std::uint32_t kReplicates = 10000, kDim = 3;
constexpr std::size_t kCells = 64;
// 3 indices, 3 dimensions, 2 statements for fewer than 55 samplers: 1e-9 each keeps the false alarm
// of the whole file below 1e-6.
constexpr double kLevel = 1e-9;
const double kSigmas = 6.1;  // two-sided normal, 1e-9

double p_of_cells(const std::vector<double>& values) {
  std::vector<double> cells(kCells, 0);
  for (const double x : values) cells[static_cast<std::size_t>(x * kCells)] += 1;
  const double expected = static_cast<double>(values.size()) / kCells;
  double statistic = 0;
  for (const double count : cells) statistic += (count - expected) * (count - expected) / expected;
  const boost::math::chi_squared distribution(kCells - 1);
  // Too even is wrong too.
  return 2 * std::min(cdf(distribution, statistic), cdf(complement(distribution, statistic)));
}

// Of consecutive replicates, in standard deviations.
double serial_correlation(const std::vector<double>& values) {
  double sum = 0;
  for (std::size_t r = 1; r < values.size(); ++r)
    sum += (values[r] - 0.5) * (values[r - 1] - 0.5) * 12;
  return sum / std::sqrt(static_cast<double>(values.size() - 1));
}

// Point i of a randomized Hammersley set has (i + u)/N for its first coordinate, by definition: the
// set is unbiased, and u is what must be uniform.
double free_part(const Sampler& s, std::uint32_t dimension, std::uint64_t n, double x) {
  if (dimension > 0 || !test::has_property(s, "first-coordinate-rows")) return x;
  const double rows = static_cast<double>(n) * x;
  return rows - std::floor(rows);
}

// [index][dimension][replicate] of the first points and of one in the middle of the set.
std::vector<std::vector<double>> over_replicates(const Sampler& s,
                                                 const std::vector<std::uint64_t>& indices) {
  const std::uint32_t dim = std::clamp(kDim, s.min_dim, s.max_dim);
  const std::uint64_t n = s.extensible ? 64 : test::admitted_size(s, dim, 60);
  const Plan plan = make_points_plan(test::catalog(), s.name, dim, test::precisions(s).back(), n,
                                     kReplicates, 1, test::device().facts());
  PointsDump dump(test::device(), plan);
  std::vector<std::vector<double>> values(indices.size() * dim);
  for (std::uint32_t r = 0; r < kReplicates; ++r) {
    const auto drawn = dump.read(0, 48, n, r, 6);
    for (std::size_t i = 0; i < indices.size(); ++i)
      for (std::uint32_t d = 0; d < dim; ++d)
        values[i * dim + d].push_back(free_part(s, d, n, drawn[indices[i] * dim + d]));
  }
  return values;
}

}  // namespace

TEST_CASE(
    "at a fixed index every coordinate of a randomized sampler is uniform over replicates, and "
    "consecutive replicates are uncorrelated",
    "[statistical]") {
  std::size_t samplers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!s.replicable || !test::complete(s)) continue;
    ++samplers;
    const auto values = over_replicates(s, {0, 7, 45});
    for (std::size_t k = 0; k < values.size(); ++k) {
      INFO(s.name << " index and dimension " << k << ": p " << p_of_cells(values[k])
                  << ", correlation " << serial_correlation(values[k]));
      CHECK(p_of_cells(values[k]) > kLevel);
      CHECK(std::fabs(serial_correlation(values[k])) < kSigmas);
    }
  }
  CHECK(samplers > 8);
  CHECK(samplers < 55);
}
