// The verdict on a cell, and which error bars may be believed.
//
// One verdict per cell, from its largest N, in a fixed order of priority (page 5, section 0). Where
// it names no fault, it still says what could not be tested.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "estimate/convergence.hpp"
#include "estimate/estimators.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

// In order of priority:
// NOT_INTEGRABLE       f has no mean, so nothing converges
// DOMAIN_FAULT         a sample of any row is not finite
// UNRESOLVED           n_eff < 30 in one replicate, no sample of f ≥ 0 other than 0, or the row is
//                      excluded from the rate as unresolved for another reason
// PLATEAU_NUMERIC      the curve ends flat at its estimated floor
// PLATEAU_STRUCTURAL   the curve ends flat above it
// BIASED               the mean error over the replicates is not chance and not the floor
// OUTSIDE_GATE         none of these, but the rate, or the variance of independent samples, is not
//                      the expected one: page 5 has no name for it, and calls it not OK
// OK                   none of these; gated, or `reason` says why not
struct CellVerdict {
  std::string_view verdict;      // empty: none can be given, `reason` says why
  std::string reason;            // what decided, and what could not be tested
  std::optional<double> n_eff;   // N (E|f|)²/E f² of one replicate
  std::optional<double> z_bias;  // mean error in its standard errors; R ≥ 2 and sd > 0
};

struct CellFacts {
  bool mean_undefined = false, infinite_variance = false;
  std::optional<double> mean, mean_abs;  // I and E|f|
  std::uint64_t nonfinite = 0;           // samples, of all rows and replicates
  // Of the row of the largest N.
  std::optional<double> n_eff;
  ErrorStatistics errors;
  std::optional<double>
      excess_of_mean;              // excess kurtosis of Q_r, where the samples are independent
  std::string unbounded_tail;      // why that may be anything, else empty
  std::string unresolved_row;      // why it is excluded from the rate as unresolved, else empty
  std::optional<double> exact_sd;  // of Q_r: σ/√N, where the samples are independent
  double floor = 0;
  // Of the curve.
  Plateau plateau;
  RateVerdict rate;
};

// `rows_of_run`: rows of all cells of the run, at least 1: the bias test has a false-alarm
// probability of 1e-6 over all of them (Bonferroni).
CellVerdict decide_verdict(const CellFacts& facts, std::size_t rows_of_run);

// Excess kurtosis of a mean from which on its normal approximation is not believed (page 5,
// section 3).
inline constexpr double kLargestExcess = 0.1;

// What stands behind one normal approximation: the N·R values of a pooled sample, or the N of one
// replicate.
struct IntervalFacts {
  bool mean_undefined = false, infinite_variance = false;
  std::optional<double> n_eff, excess_of_mean;
  std::string unbounded_tail;         // why the excess kurtosis may be anything, else empty
  std::span<const double> variances;  // of the replicates that are pooled
  bool heavy_tailed = false;          // the errors of the replicates
};

// Takes the standard error and the interval away where they mean nothing (no mean, infinite
// variance, n_eff < 30); says so in `reason`, also where an interval stays that may cover less than
// it says.
void qualify_interval(Estimate& estimate, const IntervalFacts& facts);

// With infinite variance RMSE says how large the largest error was, no more: only the median stays.
void drop_rmse(ErrorStatistics& errors);

}  // namespace koksma
