// Error against time across the cells of a run: the gain over plain Monte Carlo and, per scene, the
// Pareto front.
#pragma once

#include "catalog/json.hpp"

namespace koksma {

// Fills in what compares a cell with plain Monte Carlo (estimator mc, which only independent points
// fit) of the same scene and precision, and of the same sum where there is one: `speed_up` of every
// row and of every tolerance, `speed_up_over`, `crossover`. The error of Monte Carlo is sqrt(σ²/N)
// where the variance σ² is known, else that of its fitted line; its time is that of its cell.
void compare_with_random(Json& cells);

// One element per scene, in the order of the cells: the rows that no other row of the scene beats
// in kernel time of one replicate and in RMSE, over samplers, estimators, precisions and sums. Of
// rows whose RMSE is believed; `front` of all, `front_replicated` of those with 2 replicates or
// more, because the one error of a single point set may be small by chance.
Json scenes_of(const Json& cells);

}  // namespace koksma
