// Runs the cases of the stability suite: each is a cell with counters, whose floors are measured
// where its curve comes near them, judged, and compared with what it must show.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "estimate/cell_result.hpp"
#include "stability/device_checks.hpp"
#include "stability/gap.hpp"
#include "stability/suite.hpp"

namespace koksma {

// Relaxed math against strict, same points: the difference of the means over the replicates.
struct RelaxedDifference {
  std::string reason;             // why there is none, else empty
  double difference = 0;          // Q relaxed less Q strict, mean over the replicates
  std::optional<double> in_rmse;  // over the RMSE of the strict cell
};

struct CaseOutcome {
  Json cell;            // as a cell of `koksma run`, with the block in full
  std::string verdict;  // empty: none
  std::optional<Demand> demand;
  std::vector<std::string> faults;  // demands that are not met; empty: it did
  std::optional<double> digits;     // −log10 of the relative RMSE at the largest N
  std::optional<double> floor_predicted, floor_bound;  // estimate and bound of the largest term
  std::optional<double> floor_seen;                    // level of a flat end that is numeric
  std::string dominates;                               // what the error at the largest N is
  std::optional<RelaxedDifference> relaxed;            // with --fast-math
};

struct SuiteOptions {
  const DeviceChecks* checks = nullptr;  // of this device; none: blocks say nothing of it
  bool fast_math = false;
  std::function<void(std::size_t, const CaseOutcome&)> progress;  // after each case; may be empty
};

// One outcome per case. A cell that can not run is an outcome of status unsupported or failed.
std::vector<CaseOutcome> run_suite(const Catalog& catalog, Device& device, Device& exact_device,
                                   const Suite& suite, const SuiteOptions& options);

// Estimated floors against seen ones: within a factor of ten, or not.
struct FloorComparison {
  std::size_t reached = 0, within_ten = 0;
  std::vector<std::string> exceptions;
};
FloorComparison compare_floors(const std::vector<CaseOutcome>& outcomes);

// Whether the cell asks for fp64 of a device that lacks it: nothing can be demanded of it then.
bool beyond_device(const Cell& cell, const DeviceFacts& device);

// What a demand says of an outcome; empty where it is met.
std::vector<std::string> unmet(const Demand& demand, const CaseOutcome& outcome,
                               const CellResult& result);

}  // namespace koksma
