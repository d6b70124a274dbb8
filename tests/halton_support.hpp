// What the tests of radical inverses share: bases, digits of coordinates, chi-squared tests.
#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "points/halton.hpp"
#include "tests/support.hpp"

namespace koksma::test {

using Wide = unsigned __int128;

// Bases 2 ... 37 (31 in Hammersley sets), so that tests share programs.
constexpr std::uint32_t kDim = 12;

inline std::uint32_t rows(const Sampler& s) { return s.options["hammersley"].get<bool>() ? 1 : 0; }

// The base of coordinate d >= rows(s).
inline std::uint32_t base_of(const Sampler& s, std::uint32_t d) {
  return first_primes(d + 1)[d - rows(s)];
}

inline int bits_of(Precision precision) { return precision == Precision::fp32 ? 23 : 52; }

// The grid cell of a coordinate.
inline std::uint64_t cell_of(double x, int bits) {
  return static_cast<std::uint64_t>(std::ldexp(x, bits));
}

// Which of n intervals, by fp64's coordinate: a centred one lies in the middle of its cell, an
// exact one was rounded down to it and is judged by the cell's upper end.
inline std::uint64_t interval_of(double x, std::uint64_t n, bool centred = true) {
  const Wide twice = 2 * Wide{cell_of(x, 52)} * n;
  return static_cast<std::uint64_t>((twice + (centred ? n : 2 * n - 1)) >> 53);
}

inline double two_sided(double statistic, double degrees) {
  const boost::math::chi_squared distribution(degrees);
  return 2 * std::min(cdf(distribution, statistic), cdf(complement(distribution, statistic)));
}

// Counts of equally likely cells; the test fails by chance with probability 1e-9.
template <typename Key>
void check_uniform(const std::map<Key, std::uint32_t>& counts, std::size_t cells) {
  double total = 0, statistic = 0;
  for (const auto& [key, count] : counts) total += count;
  const double expected = total / static_cast<double>(cells);
  for (const auto& [key, count] : counts)
    statistic += (count - expected) * (count - expected) / expected;
  statistic += static_cast<double>(cells - counts.size()) * expected;
  INFO(total << " draws, " << counts.size() << " of " << cells << " cells, chi-squared "
             << statistic);
  REQUIRE(expected > 5);
  REQUIRE(counts.size() <= cells);
  const boost::math::chi_squared distribution(static_cast<double>(cells - 1));
  CHECK(cdf(complement(distribution, statistic)) > 1e-9);
}

// Replicates of a set of `end` points, [replicate][point][dimension].
inline std::vector<std::vector<double>> replicates(const Sampler& s, std::uint32_t dim,
                                                   std::uint64_t end, std::uint32_t count) {
  const Plan plan =
      make_points_plan(catalog(), s.name, dim, Precision::fp64, end, count, 1, device().facts());
  PointsDump dump(device(), plan);
  std::vector<std::vector<double>> result;
  for (std::uint32_t r = 0; r < count; ++r) result.push_back(dump.read(0, end, end, r, 8));
  return result;
}

}  // namespace koksma::test
