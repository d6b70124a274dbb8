// The time side of `koksma compare`: launches as multiples of the calibration kernel, tests of
// rows, cells and the study. Method: report/compare.hpp.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "report/compare.hpp"
#include "report/rank_test.hpp"

namespace koksma {

// Logarithms of the launches of a row and of the calibration beside each: 0 where that is not asked
// for, or not one per launch. Empty where the row has no single times, or one of them is 0.
struct Launches {
  std::vector<double> times, calibrations;
};
Launches launches_of(const Json& row, bool calibrated);

// Why launches of these two cells are no times of the same: another number of replicates, or
// another limit on launches (`koksma run --launches`; the usual in files that have none), as few of
// them make one run each where the usual launches make several. Empty: they are.
std::string why_not_timed(const Json& base_cell, const Json& new_cell);

// Times less this share of the calibrations (report/compare_share.hpp).
Stratum less_followed(const Launches& base, const Launches& now, double share);

// One row: Hodges-Lehmann ratio and Mann-Whitney test; not decided yet.
TimeChange time_change(const Stratum& row);

// Several rows together: the median of their ratios and van Elteren's test; not decided yet.
TimeChange combined_change(const std::vector<Stratum>& rows);

// How far ratios of things that did not change lie apart, as the standard deviation of their
// logarithms, seen in the lower part of all: q40 - q5 beside the same of normal variables (at
// Blom's 1958 positions). What is slower, up to 60 % of all, lies above and does not count; what is
// slower by the same factor everywhere cancels. 0 of fewer than kLeastForSpread ratios.
inline constexpr std::size_t kLeastForSpread = 10;
double spread_of(const std::vector<double>& ratios);

// Degrees of freedom of a spread seen in so many ratios: with those, an estimated standard
// deviation of normal variables has the relative variance that q40 - q5 has, 2.36 / n for large n
// (from the asymptotic covariance of sample quantiles, David & Nagaraja 2003, 10.2), 1 / (2 dof).
inline double spread_dof(std::size_t ratios) { return static_cast<double>(ratios) / 4.72; }

// Single rows and cells lie further out than normal variables do: each is disturbed by itself. Of
// 300 pairs of runs of equal builds the 90 % and 99.9 % quantiles of cells are
// 1.28 and 4.09 spreads, of rows 1.44 and 4.52: 3.2 and 3.1 times, as of Student's variable with 8
// or 9 degrees of freedom (a normal one: 2.4). 10, as fewer cost power: of single cells 30 % slower
// amid 5 % of noise, 58 of 60 are found with 10, 53 with 8 (tests/report_compare_test.cpp).
inline constexpr double kTailDof = 10;
inline double single_dof(std::size_t ratios) { return std::min(spread_dof(ratios), kTailDof); }

// A change beyond the threshold, beyond p_limit, and beyond what a Student variable exceeds with
// that probability, times the spread (of the logarithm). dof > 0; a spread of 0 is none. Undecided
// where it is not beyond them once it is as much nearer to none as these logarithms explain.
void decide(TimeChange& time, double threshold, double p_limit, double spread, double dof,
            const Interval& explained = {0, 0});

}  // namespace koksma
