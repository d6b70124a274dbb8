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
#include <vector>

#include "estimate/convergence.hpp"
#include "estimate/estimators.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

// In order of priority:
// NOT_INTEGRABLE       f has no mean, so nothing converges
// UNSTABLE_INTEGRATOR  f solves a differential equation, and a sample of any row is not finite, above
//                      10 times the bound of the true solution, or above 1e30 E|f|
// DOMAIN_FAULT         a sample of any row is not finite, a coordinate lies outside the range of its
//                      set, or a sample index was not used exactly once
// UNRESOLVED           n_eff < 30 in one replicate, by the exact moments or those of the samples; no
//                      sample other than 0; or, of unknown n_eff, RMSE > E|f|/2
// PLATEAU_NUMERIC      the curve ends flat at its estimated floor
// PLATEAU_STRUCTURAL   the curve ends flat above it
// BIASED               the mean error over the replicates is not chance and not the floor
// OUTSIDE_GATE         none of these, but the rate, or the variance of independent samples, is not
//                      the expected one: page 5 has no name for it, and calls it not OK
// OK                   none of these; gated, or `reason` says why not
struct CellVerdict {
  std::string_view verdict;             // empty: none can be given, `reason` says why
  std::vector<std::string_view> marks;  // beside any verdict; OVERFLOW: see `CellFacts::overflows`
  std::string reason;            // what decided, and what could not be tested
  std::optional<double> n_eff;   // N (E|f|)²/E f² of one replicate
  std::optional<double> empirical_n_eff;  // the same of the samples that were counted
  std::optional<double> z_bias;  // mean error in its standard errors; R ≥ 2 and sd > 0
};

struct CellFacts {
  bool mean_undefined = false, infinite_variance = false;
  bool overflows = false;  // the exact value, a moment of f or of f_h is above the range of double
  std::optional<double> mean, mean_abs;  // I and E|f|
  // Of all rows and replicates.
  std::uint64_t nonfinite = 0;             // samples
  std::uint64_t nonfinite_replicates = 0;  // Q_r, also of finite samples
  bool ode = false;             // f solves a differential equation
  std::optional<double> bound;  // of |f|, where it does
  double largest = 0;           // |Q_r|: a sample was at least as large
  // Where the samples were counted (`koksma stability`).
  std::optional<std::uint64_t> blow_ups;      // samples above 10 times the bound, or 1e30 E|f|
  std::optional<std::uint64_t> out_of_range;  // coordinates
  std::optional<std::uint64_t> hits;          // samples other than 0
  bool index_fault = false;
  // Of the row of the largest N.
  std::optional<double> n_eff, empirical_n_eff;
  ErrorStatistics errors;
  std::optional<double>
      excess_of_mean;              // excess kurtosis of Q_r, where the samples are independent
  std::string unbounded_tail;      // why that may be anything, else empty
  std::string unresolved_row;      // why its errors mean nothing, else empty
  std::optional<double> exact_sd;  // of Q_r: σ/√N, where the samples are independent
  double floor = 0;                // estimated
  std::string_view floor_from;     // the term that is the largest; may be empty
  // Of the curve.
  Plateau plateau;
  RateVerdict rate;
};

// `rows_of_run`: rows of all cells of the run, at least 1: the bias test has a false-alarm
// probability of 1e-6 over all of them (Bonferroni).
CellVerdict decide_verdict(const CellFacts& facts, std::size_t rows_of_run);

// What a sample, or a pooled one, must show before its errors mean anything.
struct ResolutionFacts {
  bool infinite_variance = false;  // then n_eff and the RMSE have no meaning
  std::optional<double> n_eff;     // by the exact moments
  std::optional<double> empirical_n_eff;  // (Σ|f|)²/Σf²: blind to what was never hit
  bool hit_nothing = false;               // every sample is 0, though f is not
  std::optional<double> error, mean_abs;  // RMSE, or a standard error; E|f|
  double floor = 0;                       // an error below 3 of it is no sampling error
};

// Empty where they do.
std::string why_unresolved(const ResolutionFacts& facts);

// f ≥ 0 of mean > 0, or any f that is not 0 by its E|f|, of which every sample was 0.
bool hit_nothing(const std::optional<double>& mean, const std::optional<double>& mean_abs,
                 std::span<const double> estimates, const std::optional<std::uint64_t>& hits);

// |mean error| over R replicates of this standard deviation is no chance, at level 1e-6 / rows;
// R ≥ 2, sd ≥ 0, normal errors.
bool is_significant(double mean_error, double sd, std::size_t replicates, std::size_t rows_of_run);

// Excess kurtosis of a mean from which on its normal approximation is not believed (page 5,
// section 3).
inline constexpr double kLargestExcess = 0.1;

// What stands behind one normal approximation: the N·R values of a pooled sample, or the N of one
// replicate.
struct IntervalFacts {
  bool mean_undefined = false, infinite_variance = false;
  std::string unresolved;  // why the sample says nothing, else empty
  std::optional<double> excess_of_mean;
  std::string unbounded_tail;         // why the excess kurtosis may be anything, else empty
  std::span<const double> variances;  // of the replicates that are pooled
  bool heavy_tailed = false;          // the errors of the replicates
};

// Takes the standard error and the interval away where they mean nothing (no mean, infinite
// variance, an unresolved sample); says so in `reason`, also where an interval stays that may cover less than
// it says.
void qualify_interval(Estimate& estimate, const IntervalFacts& facts);

// Of an unresolved sample the interval of the RMSE means nothing.
void drop_rmse_interval(ErrorStatistics& errors, std::string_view method);

// With infinite variance RMSE says how large the largest error was, no more: only the median stays.
void drop_rmse(ErrorStatistics& errors);

}  // namespace koksma
