// Results as JSON. Non-finite and unknown numbers are null, never a bare NaN.
#pragma once

#include "catalog/json.hpp"
#include "estimate/measure.hpp"

namespace koksma {

// One element of `cells` in the results file (results/results.schema.json). `plan` may be null when
// planning failed.
Json cell_to_json(const Catalog& catalog, const CellResult& result, const Plan* plan);

// The part that identifies a cell: scene, sampler, estimator, precision, sum, sizes, replicates,
// seed, and when it stops.
Json cell_identity(const Cell& cell);

// null for what is absent or not finite.
Json number_or_null(const std::optional<double>& value);

}  // namespace koksma
