#include "estimate/kurtosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimate/exact_sum.hpp"

namespace koksma {

namespace {

// Measured on 500 seeds of 4096 values each, 2026-11-24: not believed are all lognormal samples
// from sigma = 2 on (0.93 of them without the exact variance, from 2.5 on 0.994), 0.31 at sigma =
// 1, 0.02 at 0.5, none of normal and 0.004 of exponential values.
constexpr double kFewestInVariance = 20;
constexpr double kLargestShare = 0.5;   // of one value, of the fourth moment
constexpr double kLeastVariance = 0.5;  // of the exact one

}  // namespace

Kurtosis estimate_kurtosis(std::span<const double> values, std::optional<double> variance) {
  Kurtosis result;
  ExactSum sum;
  sum.add(values);
  if (values.size() < kFewestForKurtosis || sum.nonfinite() > 0) return result;
  const double mean = sum.rounded_quotient(values.size());
  // Deviations over the largest one: fourth powers of large values overflow.
  double largest = 0;
  for (const double y : values) largest = std::max(largest, std::fabs(y - mean));
  if (!(largest > 0)) {
    if (!variance || *variance > 0)
      result.unbounded = fmt::format("the first {} values of f are all alike", values.size());
    return result;
  }
  double m2 = 0, m4 = 0;
  for (const double y : values) {
    const double square = std::pow((y - mean) / largest, 2);
    m2 += square;
    m4 += square * square;
  }
  const auto size = static_cast<double>(values.size());
  const double excess = size * m4 / (m2 * m2) - 3;
  if (excess > size / kFewestInVariance || 1 > kLargestShare * m4) {
    result.unbounded =
        fmt::format("few of the first {} values of f make up its fourth moment", values.size());
  } else if (variance && std::sqrt(m2 / size) * largest < std::sqrt(kLeastVariance * *variance)) {
    result.unbounded =
        fmt::format("the first {} values of f show less than half of its variance", values.size());
  } else {
    result.excess = excess;
  }
  return result;
}

std::optional<Kurtosis> stated_kurtosis(const Integrand& integrand, const ExactValues& exact) {
  if (integrand.fourth_moment == FourthMoment::unknown)
    return Kurtosis{std::nullopt, "the fourth moment of f is infinite or unknown"};
  const bool indicator = integrand.fourth_moment == FourthMoment::indicator;
  if (!indicator || !exact.variance || !(*exact.variance > 0)) return std::nullopt;
  return Kurtosis{1 / *exact.variance - 6, ""};
}

}  // namespace koksma
