// From the replicates of every N to a judged cell, without a device: errors and what they support,
// floors, the rate, the verdict.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "estimate/cell_result.hpp"
#include "estimate/kurtosis.hpp"
#include "plan/plan.hpp"

namespace koksma {

// What judging must know of a cell besides its samples. Refers to what the caller keeps.
struct CellContext {
  const Plan& plan;
  const ExactValues& exact;
  const Kurtosis& kurtosis;        // of f
  const Solver* solver = nullptr;  // where f solves a differential equation
};

inline bool solves_ode(const CellContext& context) { return context.plan.integrand->ode_size > 0; }

// The moments of what is sampled: of the numerical solution, where f solves a differential equation
// and they are known, else of f.
struct SampledMoments {
  std::optional<double> mean, variance, mean_abs;
  bool overflow = false;  // one that is needed is finite, but above the range of double
  bool discrete = false;
};
SampledMoments sampled_moments(const CellContext& context);

// E|f| of what is sampled, or where it is unknown its bound sqrt(E f²).
std::optional<double> sampled_scale(const CellContext& context);

// N (E|f|)²/E f² of n samples; 0 where a moment is above all numbers, none where one is not known.
std::optional<double> effective_samples(const CellContext& context, std::uint64_t n);

// The floors of one replicate of n samples by formulas. `scale` stands for |I| where the integral
// is not known, `mean_error` as in FloorFacts.
Floors formula_floors(const CellContext& context, std::uint64_t n,
                      const MeasuredFloors& measured = {},
                      const std::optional<Reference>& reference = std::nullopt,
                      const std::optional<double>& mean_error = std::nullopt);

// Errors, estimate and tests of a row whose n and nonfinite are set. `estimates`: one per
// randomization; `variances`: N Var(Q_r) within them, may be empty.
void assess_row(const CellContext& context, std::span<const double> estimates,
                std::span<const double> variances, Row& row);

// All that is concluded from the rows of a cell, at least one, which are by ascending n.
// `rows_of_run` as in PreparedCell::run. May be repeated once more is known: `result.detail`
// counts.
void assess_cell(const CellContext& context, const std::optional<Reference>& reference,
                 std::size_t rows_of_run, CellResult& result);

}  // namespace koksma
