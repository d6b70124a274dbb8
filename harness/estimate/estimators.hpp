// How R replicates become one estimate with its standard error and 95 % interval.
//
// The catalog's estimators say what a sampler must guarantee and what the kernel must sum; a table
// here, keyed by the kind of interval, says how to summarise. A new kind (order statistics, strata)
// is one more entry of that table.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "catalog/catalog.hpp"
#include "estimate/interval.hpp"

namespace koksma {

struct EstimatorInput {
  std::span<const double> estimates;  // Q_r, each the mean of `samples` values
  std::span<const double>
      variances;              // sample variance of each replicate; too few or none where not summed
  std::uint64_t samples = 0;  // N, per replicate
};

struct Estimate {
  std::optional<double> value;           // none without replicates or with a non-finite one
  std::optional<double> standard_error;  // of `value`, which spends N·R samples
  std::optional<Interval> interval;      // 95 %
  std::string reason;                    // why something is absent, else empty
};

// "normal": the N·R values are one sample, its variance pooled over the replicates (two moments
// needed; also R = 1). "student-t": R ≥ 2 independent unbiased replicates. "none": the mean alone.
// Throws std::invalid_argument for another kind of interval.
Estimate summarise_estimate(const Estimator& estimator, const EstimatorInput& input);

// The kinds of interval that can be summarised.
std::vector<std::string_view> interval_kinds();

}  // namespace koksma
