// Error per time: efficiency, variance reduction, time and N to a tolerance, the gain over plain
// Monte Carlo.
//
// MSE and time are those of one replicate: its MSE × (kernel time of the launch)/R (page 6,
// definition 13). Times in seconds, errors in the unit of the integral. What cannot be said is
// absent, with the reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace koksma {

// 1/(MSE·time): P. L'Ecuyer, Efficiency improvement and variance reduction, WSC 1994, eq. 1.
std::optional<double> efficiency(double rmse, double seconds);

// σ²/(N·MSE), N all samples of one estimate: how many times those plain Monte Carlo needs for the
// same error.
std::optional<double> variance_reduction(double variance, std::uint64_t samples, double rmse);

// Seconds that N samples take.
struct Timing {
  std::uint64_t n = 0;
  double seconds = 0;
};

// T(N) = overhead + per_sample · N, both ≥ 0.
struct TimeLine {
  double overhead = 0;    // seconds
  double per_sample = 0;  // seconds
  std::size_t rows = 0;
  double largest_deviation = 0;  // max |measured / T(N) − 1| over the rows
};

// Least squares of the relative residuals 1 − T(N)/measured, so that short rows count as much as
// long ones, and a row that was disturbed (it can only be slower) by less than 1. Rows in any
// order; those without a positive finite time are ignored. One size, or times that fall with N:
// proportional or constant. None without rows.
std::optional<TimeLine> fit_times(std::span<const Timing> rows);
double seconds_at(const TimeLine& line, double n);
// The N that this time pays for; 0 where it does not pay for the overhead, infinite where samples
// cost nothing.
double samples_in(const TimeLine& line, double seconds);

// The fitted line of a convergence curve: log2 RMSE = intercept + slope · log2 N, and the N of the
// rows it was fitted to.
struct ErrorLine {
  double slope = 0, intercept = 0;
  std::uint64_t from = 0, to = 0;
};
double error_at(const ErrorLine& line, double n);

// What is known of a curve when a tolerance is asked of it.
struct CurveFacts {
  std::optional<ErrorLine> errors;
  std::string no_errors;  // why there is no line
  std::optional<TimeLine> times;
  double level = 0;          // the errors do not fall below it; 0: no such level is known
  std::string level_is;      // what it is, for the reason
  std::uint64_t most_n = 0;  // of the sampler
};

struct ToTolerance {
  std::optional<double> n;        // samples of one replicate, no whole number
  std::optional<double> seconds;  // kernel time of one replicate
  bool extrapolated = false;      // n is outside the rows of the fit
  double octaves_beyond = 0;      // log2 of how far outside
  std::string reason;             // why n or seconds is absent, else empty
};

// N where the fitted line reaches `error` > 0, and its time on the time line. However far it is
// extrapolated, it says so; but not below the level of the errors, below N = 1 or beyond the
// largest N of the sampler.
ToTolerance to_tolerance(const CurveFacts& curve, double error);

// One N of a sampler's curve beside plain Monte Carlo.
struct BesideRandom {
  std::uint64_t n = 0;
  double error = 0;         // of the sampler
  double random_error = 0;  // of Monte Carlo with as many samples, or in the same time
};

// The N from which on the sampler's error is below that of Monte Carlo: the smallest n such that it
// is below in that row and in all with a larger n. None where it is not below in the last row. Rows
// in any order.
std::optional<std::uint64_t> crossover(std::span<const BesideRandom> rows);

}  // namespace koksma
