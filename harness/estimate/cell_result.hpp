// What a cell gives: its rows, one per N, and what is concluded from them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "estimate/convergence.hpp"
#include "estimate/estimators.hpp"
#include "estimate/floors.hpp"
#include "estimate/mc_test.hpp"
#include "estimate/ode.hpp"
#include "estimate/reference.hpp"
#include "estimate/stability.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

// Seconds of repeated launches.
struct TimeStatistics {
  double median = 0, min = 0;
  double spread = 0;  // interquartile range
  std::size_t count = 0;
};

// Between launches that are queued behind each other 5 to 15 us go by on PoCL, and about 8 us go
// into a launch's start: both less than a tenth of launches that take so long.
inline constexpr double kSecondsOfRuns = 0.0002;

struct Row {
  std::uint64_t n = 0;  // samples per replicate
  std::uint32_t log2_block = 0;
  std::vector<double> estimates;  // Q_r
  std::string unresolved;         // why its errors mean nothing, else empty
  ErrorStatistics errors;
  Estimate estimate;
  McTest mc_test;
  std::uint64_t nonfinite = 0;  // samples, all replicates
  // Of all replicates: where the plan has counters, or a partial sum is not finite.
  std::optional<Counters> counters;
  std::optional<double> kappa;   // sum |f| / |sum f|, where counted
  bool grid_limited = false;     // more points than the coordinates can tell apart
  bool below_reference = false;  // the RMSE is below 3 x the error of the reference
  std::string error_reason;      // why there are no errors, or none to believe
  // Of one run of all replicates; `kernel` of launches that make runs_per_launch of them each.
  TimeStatistics kernel, wall;
  std::uint32_t runs_per_launch = 1;
  double merged_kernel_s = 0;  // median of the kernel's part of `wall`
  // Seconds of a run in every timed launch in order, and of the calibration kernel beside it
  // (estimate/timed_launches.hpp); the latter is empty where nothing was calibrated.
  std::vector<double> kernel_times, calibration;
};

enum class CellStatus { ok, skipped, unsupported, failed };
std::string_view status_name(CellStatus status);

// What `koksma stability` measures beside a cell; absent what it did not.
struct IndexFlags {  // of all sample indices of the largest N, modulo 2^64
  bool sum_ok = false, sum_of_squares_ok = false, xor_of_hashes_ok = false;
};
struct Reproducibility {  // of one estimate over launch shapes
  std::size_t launch_shapes = 0, distinct_sums = 0;
  std::optional<double> ulp_spread;  // largest less smallest, in ulp of the estimate
};
struct PrecisionGap {                // at the same integer points
  std::optional<double> difference;  // mean over the replicates of Q in fp32 less Q in fp64
  std::optional<double> in_rmse64;   // the same over the RMSE in fp64
};
struct StabilityDetail {
  MeasuredFloors floors;
  std::optional<IndexFlags> index;
  std::optional<Reproducibility> reproducibility;
  std::optional<bool> eft_selftest;  // error-free transformations hold on the device
  std::optional<PrecisionGap> precision_gap;
};

// Why a cell has no more rows.
struct Stopped {
  std::string by = "study";  // "study", "until", "time-budget", "beyond-n" or "sampler"
  std::string reason;
  std::uint64_t at_n = 0;               // of the last row; 0: there are none
  std::optional<std::uint64_t> next_n;  // the first that was not run, where there would be one
  double spent_s = 0;                   // wall seconds of all rows
  std::optional<double> predicted_s;    // of the row of next_n, where the budget decided
  std::optional<double> reached;        // relative RMSE of the last row
};

struct CellResult {
  Cell cell;
  CellStatus status = CellStatus::ok;
  std::string reason;
  ExactValues exact;
  std::optional<Reference> reference;  // where the integral is not known
  double build_s = 0, setup_s = 0;
  std::size_t table_bytes = 0, coefficient_bytes = 0;
  Floors floors;                 // at the largest N
  double floor = 0;              // their predicted_total()
  std::optional<OdeReport> ode;  // where f solves a differential equation
  StabilityDetail detail;
  std::vector<Row> rows;
  Stopped stopped;
  RateFit rate;
  RateVerdict verdict;
  CellVerdict stability;
};

// A cell that did not run, with why in every place where a reader looks for a number.
CellResult refused_cell(const Cell& cell, CellStatus status, const std::string& reason);

}  // namespace koksma
