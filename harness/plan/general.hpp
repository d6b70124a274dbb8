// The deliberately general twin of a plan, to measure what leaving out is worth: one kernel per
// family of points, written once for all its samplers and all estimators (kernels/general/). What
// the plan knows when its kernel is built, the twin reads at run time: dimension, randomization,
// grid of coordinates, what is squared, whether samples are counted. It always sums both moments,
// its table has every column, and its loops over dimensions are not unrolled. Samples, blocks and
// the order of additions are the plan's, so both estimates agree to rounding.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "plan/plan.hpp"

namespace koksma {

struct GeneralPlan {
  // Sums of y, of squares, and one word that counts (Plan::words); `plan` points to it.
  std::shared_ptr<const Estimator> estimator;
  Plan plan;
};

// Why there is no general kernel for a plan, in words that end a sentence; empty: there is one.
std::optional<std::string> no_general_kernel(const Plan& plan);

// UnsupportedError where no_general_kernel has a reason.
GeneralPlan general_plan(const Catalog& catalog, const Plan& plan);

// The switches, then the family's table with all its columns, as bytes ready to upload. Must not be
// called for a family that prepares its sets on a device.
std::vector<std::byte> general_table(const GeneralPlan& general);

// Where kernels/general/ has the family's piece; whether it exists is no_general_kernel's.
std::string general_kernel(const Plan& plan);

// The defines that general pieces know beside those of the prelude: the places of the switches.
std::string general_defines(const Plan& plan);

}  // namespace koksma
