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
// logarithms, seen in the lower part of all: q40 - q10 beside the same of normal variables (at
// Blom's 1958 positions). What is slower, up to 60 % of all, lies above and does not count; what is
// slower by the same factor everywhere cancels. 0 of fewer than kLeastForSpread ratios.
inline constexpr std::size_t kLeastForSpread = 10;
double spread_of(const std::vector<double>& ratios);

// Degrees of freedom of a spread seen in so many ratios: with those, an estimated standard
// deviation of normal variables has the relative variance that q40 - q10 has, 2.61 / n for large n
// (from the asymptotic covariance of sample quantiles, David & Nagaraja 2003, 10.2), 1 / (2 dof).
inline double spread_dof(std::size_t ratios) { return static_cast<double>(ratios) / 5.22; }

// A change beyond the threshold, beyond p_limit, and beyond what a Student variable exceeds with
// that probability, times the spread (of the logarithm): so few ratios tell a spread that a normal
// one's limit would be exceeded by chance. dof > 0; a spread of 0 is none.
void decide(TimeChange& time, double threshold, double p_limit, double spread, double dof);

}  // namespace koksma
