// Error per time: efficiency, variance reduction, time to a tolerance, speed-up.
//
// MSE and time are those of one replicate: its MSE × (kernel time of the launch)/R (page 6,
// definition 13). Times in seconds, errors in the unit of the integral. What cannot be said is
// absent.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace koksma {

// One row of a convergence curve.
struct TimePoint {
  double seconds = 0;
  double rmse = 0;
};

// 1/(MSE·time): P. L'Ecuyer, Efficiency improvement and variance reduction, WSC 1994, eq. 1.
std::optional<double> efficiency(double rmse, double seconds);

// σ²/(N·MSE), N all samples of one estimate: how many times those plain Monte Carlo needs for the
// same error.
std::optional<double> variance_reduction(double variance, std::uint64_t samples, double rmse);

struct TimeToTolerance {
  std::optional<double> seconds;
  bool extrapolated = false;  // by at most one octave (a factor 2 of time) beyond the rows
  std::string reason;         // why there is no time, else empty
};

// When the RMSE falls below `tolerance` for good: linear in (log T, log RMSE) in the last interval
// of rows that crosses it, extrapolated from the two end rows by at most one octave. Rows in any
// order; those with a time or RMSE that is not positive and finite are ignored.
TimeToTolerance time_to_tolerance(std::span<const TimePoint> rows, double tolerance);

// Time of plain Monte Carlo over that of `other` at the error of `other`. Monte Carlo gets there by
// its exact law T ∝ 1/MSE, so one of its rows suffices: the ratio of the two efficiencies (P. W.
// Glynn, W. Whitt, The asymptotic efficiency of simulation estimators, Oper. Res. 40 (1992)).
std::optional<double> speed_up(const TimePoint& monte_carlo, const TimePoint& other);

}  // namespace koksma
