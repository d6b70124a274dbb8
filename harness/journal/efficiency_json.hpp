// `efficiency` of a cell: error against time, as results/results.schema.json describes it. What
// needs other cells of the run is null until the report has seen them.
#pragma once

#include "catalog/json.hpp"
#include "estimate/cell_result.hpp"

namespace koksma {

// The tolerances are 10^-1 … 10^-kTolerances.
inline constexpr int kTolerances = 12;

// `cell` is the JSON of the cell so far, with its rows; max_log2_n that of its sampler.
Json efficiency_json(const CellResult& result, const Json& cell, unsigned max_log2_n);

}  // namespace koksma
