// The convergence rate: slope of log2 RMSE against log2 N over the rows that may be fitted, and its
// verdict.
//
// Weighted least squares, weights 1/Var(log2 RMSE); the interval is a cluster bootstrap that
// resamples replicates with their whole N-path, for prefixes of one randomization are dependent
// across N (A. C. Davison, D. V. Hinkley, Bootstrap Methods and their Application, 1997,
// section 3.8). Rules of exclusion: page 5, sections 2.9 and 3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "catalog/catalog.hpp"
#include "estimate/bootstrap.hpp"
#include "estimate/interval.hpp"
#include "estimate/plateau.hpp"

namespace koksma {

// One N of a curve. Replicate r is the same randomization in every row.
struct ConvergenceRow {
  std::uint64_t samples = 0;   // N
  std::vector<double> errors;  // signed e_r = Q_r − I
  double floor = 0;  // estimated rms error level of rounding, grid and model; 0: none known
  std::optional<double> mean_abs;  // E|f|
  std::optional<double> n_eff;     // N (E|f|)² / E f²
  std::string unresolved;          // why its errors mean nothing for another reason, else empty
};

struct FitOptions {
  bool infinite_variance = false;  // then only the median is fitted and no row counts as unresolved
  std::size_t resamples = kBootstrapResamples;
  std::uint64_t seed = kBootstrapSeed;
};

struct ExcludedRow {
  std::uint64_t samples = 0;
  std::string reason;
};

struct LocalSlope {
  std::uint64_t from = 0;  // N of two consecutive used rows
  std::uint64_t to = 0;
  double slope = 0;  // of log2 RMSE; of log2 median |e| when the variance is infinite
};

struct RateFit {
  std::optional<double> slope;       // of log2 RMSE; none: see reason
  std::optional<double> intercept;   // log2 RMSE at N = 1 on the same line, in the errors' unit
  std::optional<Interval> interval;  // 95 %; none for R < 8
  std::optional<double>
      median_slope;  // of log2 median |e|, fitted when heavy-tailed or of infinite variance
  std::optional<Interval> median_interval;
  std::string reason;               // why slope or interval is absent, else empty
  bool heavy_tailed = false;        // RMSE / median |e| > 3 in 2 used rows and in a quarter of them
  bool deterministic = false;       // R = 1: a slope by ordinary least squares, never an interval
  std::size_t replicates = 0;       // R
  std::vector<std::uint64_t> used;  // N, ascending
  std::vector<ExcludedRow> excluded;
  std::vector<LocalSlope> local_slopes;
  Plateau plateau;            // decided on all rows, before any is excluded for its floor
  std::optional<Break> bend;  // of the rows that were left then
};

// Rows in any order. Excluded, with a reason: N not a power of two, N < 2^8, N repeated, replicates
// missing or of another count than most, a non-finite error, RMSE = 0, RMSE < 3·floor, RMSE >
// E|f|/2, n_eff < 30; then, of a curve that ends flat, the rows from its bend on, or those of the
// flat end where the bend is not accepted, unless that is the whole curve. Fewer than 6 rows left:
// no slope. About 1 ms for R = 32, 13 rows, 1000 resamples.
RateFit fit_rate(std::span<const ConvergenceRow> rows, const FitOptions& options = {});

struct RateVerdict {
  std::optional<double> expected;  // constant + per_dimension/d
  std::optional<double> target;    // where there is a gate: its one-sided bound, or expected, with
                                   // the log correction (d − 1)/(2 ln 2^12)
  std::string_view verdict;  // "within-gate", "outside-gate", "reported", "no-theory", "no-rate"
  std::string reason;        // why a gate was not applied, or why there is no rate
};

// The gates of page 5, section 1.9, are set for R = 32 (5 sd of the slope), so fewer replicates are
// only reported.
inline constexpr std::size_t kGateReplicates = 32;

// Nor does a fit of fewer rows: the tolerances are 5 standard deviations of the slope over the 9
// rows 2^8 … 2^16, the first of which may be unresolved; over 8 rows they are still 4.2.
inline constexpr std::size_t kGateRows = 8;

// Effective samples below which nothing is said about an error (page 5, section 0).
inline constexpr double kFewestEffective = 30;

// How the reason begins why an unresolved row is excluded.
inline constexpr std::string_view kUnresolved = "unresolved: ";

// Below so many estimated floors an error is one of rounding (page 5, section 2.9).
inline constexpr double kFloorFactor = 3;

// Replicates below which a cluster bootstrap covers less than 88 %: no interval.
inline constexpr std::size_t kFewestForInterval = 8;

// The rate at these parameters of the integrand: what depends on them becomes part of the constant,
// and a gate that does not hold there is dropped.
ExpectedRate rate_at(ExpectedRate rate, std::span<const double> parameters);

// The slope that is expected at these parameters and d ≥ 1.
double expected_slope(const ExpectedRate& rate, std::span<const double> parameters, unsigned d);

// `expected` is one of rate_at. d ≥ 1. Within the gate is |slope − target| ≤ tolerance, or slope ≤
// target where it is one-sided. Heavy tails, a deterministic fit, d above the gate and R < 32 turn
// a gate into "reported".
RateVerdict judge(const RateFit& rate, const std::optional<ExpectedRate>& expected, unsigned d);

}  // namespace koksma
