// When the rows of a cell end: by what was asked for, by a time budget or by the error reached.
//
// Rows go up in N. A row that is run is never cut, so a budget is kept by predicting the next row
// from those measured; the first row is always run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "estimate/cell_result.hpp"
#include "estimate/efficiency.hpp"
#include "estimate/timed_launches.hpp"
#include "study/study.hpp"

namespace koksma {

// Seconds of all launches of a row, at most `most` of them, when one takes `launch` > 0 seconds.
double row_seconds(double launch, std::size_t most = kLaunchesAlone);

// RMSE of the row relative to |I|, or absolute where I = 0; of unknown integrals relative to the
// reference, or where the cell is its own, the replicates' standard deviation relative to their
// mean. None of an unresolved row, of a row below the reference's error, or where there is no
// error.
std::optional<double> reached_error(const Row& row, const std::optional<double>& mean,
                                    const std::optional<Reference>& reference);

// What is known after a row.
struct StopFacts {
  StopRule rule;
  std::uint64_t n = 0;                         // of the row
  std::optional<std::uint64_t> next;           // none: there are no more sizes
  bool sampler_ends = false;                   // and that for the sampler's sake
  std::optional<double> reached;               // reached_error()
  double spent = 0;                            // seconds since before the first row
  std::span<const Timing> launches;            // wall seconds of one launch, per row so far
  std::size_t most_launches = kLaunchesAlone;  // of the next row
};

// Empty: the next row is run. The first that holds of: the error is reached, there are no more
// sizes, the next row would exceed the budget.
std::optional<Stopped> why_stop(const StopFacts& facts);

// Where the next row can not be run, for the reason that the sampler gives.
Stopped stopped_by_sampler(const StopFacts& facts, const std::string& refusal);

}  // namespace koksma
