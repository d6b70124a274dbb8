// The time side of `koksma compare`: launches as multiples of the calibration kernel, tests of
// rows, cells and the study. Method: report/compare.hpp.
#pragma once

#include <vector>

#include "report/compare.hpp"
#include "report/rank_test.hpp"

namespace koksma {

// Logarithms of the launches of a row, as multiples of the calibration beside each where the row
// has one and it is asked for. Empty where the row has no single times, or one of them is 0.
std::vector<double> log_times(const Json& row, bool calibrated);

// One row: Hodges-Lehmann ratio and Mann-Whitney test; not decided yet.
TimeChange time_change(const Stratum& row);

// Several rows together: the median of their ratios and van Elteren's test; not decided yet.
TimeChange combined_change(const std::vector<Stratum>& rows);

// How far ratios of things that did not change lie apart, as the standard deviation of their
// logarithms, seen in the lower part of all: (q30 - q10) / 0.757, the quantiles of a normal
// distribution. What is slower, up to 70 % of all, lies above and does not count; what is slower
// by the same factor everywhere cancels. 0 of fewer than kLeastForSpread ratios.
inline constexpr std::size_t kLeastForSpread = 10;
double spread_of(const std::vector<double>& ratios);

// A change beyond the threshold, beyond p_limit, and beyond what a normal variable of this standard
// deviation (of the logarithm) exceeds with that probability.
void decide(TimeChange& time, double threshold, double p_limit, double spread);

}  // namespace koksma
