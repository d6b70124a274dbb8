// The `stability` block of a cell in the results (5-numerics, section 4).
#pragma once

#include <optional>

#include "catalog/json.hpp"
#include "estimate/cell_result.hpp"
#include "plan/plan.hpp"

namespace koksma {

// `plan` may be null. `cell`: the JSON of the cell so far, with its rows, convergence and
// efficiency.
Json stability_json(const CellResult& result, const Plan* plan, const Json& cell);

// [low, high] or null.
Json interval_json(const std::optional<Interval>& interval);

}  // namespace koksma
