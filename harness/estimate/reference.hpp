// What errors are taken against. Where the integral is known, that; where it is not, the run's own
// best estimate: of the cells of a scene one is chosen before anything is measured, by what theory
// promises, runs first, and its estimate at its largest N stands for the integral. Errors of that
// cell are then too small by construction: those of its last row, and the rate of a single point
// set, say nothing. The others' carry the estimate's own error, which is part of their floor.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "estimate/interval.hpp"
#include "study/study.hpp"

namespace koksma {

// An estimate in the integral's place.
struct Reference {
  double value = 0;
  std::optional<double> error;  // standard error, or what the interval makes of it; none: unknown
  std::string from;     // "sobol-owen with rqmc, N = 65536, 32 replicates", and of the error
  bool itself = false;  // the last estimate of the cell that is measured against it
};

// An estimate at `from` with its standard error; where there is none, half the width of its
// interval over 1.96.
Reference make_reference(double value, std::optional<double> standard_error,
                         const std::optional<Interval>& interval, std::string from);

// The cells of one scene as indices into `cells`, the best promise first: estimators with an
// interval before those without, independent samples last among them, fp64 before fp32, the
// steepest expected rate, of equal ones no Student t over linear scrambles (their errors are
// heavy-tailed), the most samples, the order of the study. A median without a rate of its own
// promises that of the single randomizations.
std::vector<std::size_t> by_promise(const Catalog& catalog, std::span<const Cell> cells,
                                    std::vector<std::size_t> candidates);

// The last row of a finished cell's JSON as a reference; none where the cell has no finite
// estimate.
std::optional<Reference> reference_from(const Json& cell);

}  // namespace koksma
