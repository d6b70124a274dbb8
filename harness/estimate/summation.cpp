#include "estimate/summation.hpp"

#include <algorithm>
#include <cmath>

namespace koksma {
namespace {

// sum of factor n^p u^q, as the entry gives it.
double value_at(const std::vector<RoundingTerm>& terms, double n, double u) {
  double value = 0;
  for (const RoundingTerm& term : terms)
    value += term.factor * std::pow(n, term.power_of_n) * std::pow(u, term.power_of_u);
  return value;
}

SummationError error_at(const std::vector<RoundingTerm>& terms, double absolute,
                        const SumAlgorithm& sum, Precision precision, double n) {
  const bool fp64 = sum.needs_fp64 || precision == Precision::fp64;
  return {std::min(value_at(terms, n, fp64 ? 0x1p-53 : 0x1p-24), 1.0), absolute};
}

}  // namespace

SummationError summation_bound(const SumAlgorithm& sum, Precision precision, double n_per_lane) {
  const double n = std::max(n_per_lane, 1.0);
  return error_at(sum.bound, sum.quantum / 2, sum, precision, n);
}

// Roundings to a quantum are uniform over it: rms quantum / sqrt(12) a term.
SummationError summation_estimate(const SumAlgorithm& sum, Precision precision, double n_per_lane) {
  const double n = std::max(n_per_lane, 1.0);
  return error_at(sum.estimate, sum.quantum / std::sqrt(12 * n), sum, precision, n);
}

}  // namespace koksma
