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
#include "estimate/exact_sum.hpp"
#include "estimate/interval.hpp"

namespace koksma {

struct EstimatorInput {
  // Q_r, each the mean of `samples` values; of a median all the randomizations, not their medians
  std::span<const double> estimates;
  // N Var(Q_r) of each replicate, estimated within it: of independent samples the sample variance.
  // Too few or none where not summed.
  std::span<const double> variances;
  std::uint64_t samples = 0;  // N, per replicate
};

struct Estimate {
  std::optional<double> value;           // none without replicates or with a non-finite one
  std::optional<double> standard_error;  // of `value`, which spends N·R samples
  std::optional<Interval> interval;
  double level = 0.95;  // that the interval covers with
  std::string reason;   // why something is absent, else empty
};

// "normal": the N·R values are one sample, its variance pooled over the replicates (two moments
// needed; also R = 1). "student-t": R ≥ 2 independent unbiased replicates. "order-statistics": the
// median of all randomizations, with the narrowest symmetric pair of order statistics that covers
// the median of their law with at least 95 %, and its exact level. "none": the mean alone. Throws
// std::invalid_argument for another kind of interval.
Estimate summarise_estimate(const Estimator& estimator, const EstimatorInput& input);

// N Var(Q) of one replicate of N samples from its sums Σ y and Σ of the squares that the
// estimator's second_moment names, about y0 where there is a centre. "values": the sample variance.
// "pair-means": twice the sample variance of the N/2 means of pairs. "pair-differences": half the
// mean square of the N/2 differences of two draws in a stratum (Cochran 1977, eq. 5.23 with n_h = 2
// and equal strata). None where a sum is not finite or N is too small.
std::optional<double> variance_of_replicate(const std::string& second_moment, std::uint64_t n,
                                            const ExactSum& sum_y, const ExactSum& sum_squares,
                                            double y0, double unit_roundoff);

// The medians of consecutive groups of `size` (odd) estimates.
std::vector<double> group_medians(std::span<const double> estimates, std::uint32_t size);

// The kinds of interval that can be summarised.
std::vector<std::string_view> interval_kinds();

}  // namespace koksma
