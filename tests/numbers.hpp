// Small pieces of arithmetic that several tests share.
#pragma once

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace koksma::test {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// k of x = k 2^-52, rounded down.
inline std::uint64_t word52(double x) { return static_cast<std::uint64_t>(std::ldexp(x, 52)); }

// floor(x n) for x = k 2^-53, without rounding.
inline std::uint64_t stratum(double x, std::uint64_t n) {
  const auto k = static_cast<std::uint64_t>(std::ldexp(x, 53));
  return static_cast<std::uint64_t>(static_cast<unsigned __int128>(k) * n >> 53);
}

// The distance of two points of the circle [0,1).
inline double circle_distance(double a, double b) {
  const double d = std::fabs(a - b);
  return std::min(d, 1 - d);
}

// The p-value of a chi-squared statistic that may be too small as well as too large.
inline double two_sided_chi2(double statistic, double degrees) {
  const boost::math::chi_squared distribution(degrees);
  return 2 * std::min(cdf(distribution, statistic), cdf(complement(distribution, statistic)));
}

}  // namespace koksma::test
