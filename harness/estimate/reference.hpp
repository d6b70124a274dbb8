// What errors are taken against. Where the integral is known, that; where it is not, the run's own
// best estimate: of the cells of a scene one is chosen before anything is measured, by what theory
// promises, runs first, and its estimate at its largest N stands for the integral. Errors of that
// cell are then too small by construction, most of all in its last row; the others' carry the
// estimate's own error, which is part of their floor.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "study/study.hpp"

namespace koksma {

// An estimate in the integral's place.
struct Reference {
  double value = 0;
  std::optional<double> standard_error;  // none where the estimator has none
  std::string from;                      // "sobol-owen with rqmc, N = 65536, 32 replicates"
};

// The cells of one scene as indices into `cells`, the best promise first: replicated estimators
// before single point sets, fp64 before fp32, the steepest expected rate, the most samples, the
// order of the study.
std::vector<std::size_t> by_promise(const Catalog& catalog, std::span<const Cell> cells,
                                    std::vector<std::size_t> candidates);

// The last row of a finished cell's JSON as a reference; none where the cell has no finite
// estimate.
std::optional<Reference> reference_from(const Json& cell);

}  // namespace koksma
