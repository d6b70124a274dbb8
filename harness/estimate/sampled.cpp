// Of assess.hpp: the moments of what is sampled, and the floors by formulas.
#include <algorithm>
#include <cmath>
#include <limits>

#include "catalog/lanes.hpp"
#include "estimate/assess.hpp"
#include "estimate/summation.hpp"

namespace koksma {
namespace {

// Of equal terms all roundings go the same way, at a sixth of the bound (fp32 sums of 0.1, page 5,
// appendix C: 6.3 to 6.5 at 2^16 to 2^24).
constexpr double kConstantRounding = 1.0 / 6;
// Of u |I|: rms of an error that is uniform over an ulp of a number of unknown mantissa, 0.29 to
// 0.58.
constexpr double kResultRounding = 0.4;

// E of floors. The means over many accumulators average their roundings out, unless all add the
// same numbers; the result is rounded to double once.
void add_summation(const CellContext& context, std::uint64_t n, double scale, FloorFacts& facts) {
  const Plan& plan = context.plan;
  const double n_per_lane =
      std::max(1.0, std::min(static_cast<double>(n), std::exp2(log2_block_length(n))) / kLanes);
  const SummationError bound = summation_bound(*plan.sum, plan.precision, n_per_lane);
  const SummationError estimate = summation_estimate(*plan.sum, plan.precision, n_per_lane);
  const double result = 0x1p-53 * std::fabs(facts.mean.value_or(scale));
  facts.summation_bound = bound.of(scale) + result;
  const double accumulators = std::max(1.0, static_cast<double>(n) / n_per_lane);
  const bool constant = facts.sd && *facts.sd == 0;
  facts.summation =
      constant ? kConstantRounding * bound.of(scale) : estimate.of(scale) / std::sqrt(accumulators);
  facts.result_rounding = kResultRounding * result;
}

}  // namespace

SampledMoments sampled_moments(const CellContext& context) {
  const ExactValues& exact = context.exact;
  const bool known = exact.discrete_mean || exact.discrete_variance || exact.discrete_mean_abs;
  if (solves_ode(context) && (known || exact.discrete_overflows))
    return {exact.discrete_mean, exact.discrete_variance, exact.discrete_mean_abs,
            exact.discrete_overflows, true};
  return {exact.mean, exact.variance, exact.mean_abs, exact.variance_overflows, false};
}

std::optional<double> sampled_scale(const CellContext& context) {
  const SampledMoments f = sampled_moments(context);
  if (f.mean_abs) return f.mean_abs;
  if (f.mean && f.variance) return std::hypot(*f.mean, std::sqrt(*f.variance));
  return std::nullopt;
}

std::optional<double> effective_samples(const CellContext& context, std::uint64_t n) {
  const SampledMoments f = sampled_moments(context);
  if (f.overflow) {
    // E f² is above this; n_eff below its value there.
    const double largest = std::sqrt(std::numeric_limits<double>::max());
    const double most = static_cast<double>(n) * std::pow(f.mean_abs.value_or(0) / largest, 2);
    return most < kFewestEffective ? std::optional(0.0) : std::nullopt;
  }
  if (!f.mean || !f.variance || !f.mean_abs) return std::nullopt;
  // Squares of the moments may leave the range of double, their ratio does not.
  const double root = std::hypot(*f.mean, std::sqrt(*f.variance));
  if (!(root > 0)) return std::nullopt;
  return static_cast<double>(n) * std::pow(*f.mean_abs / root, 2);
}

Floors formula_floors(const CellContext& context, std::uint64_t n, const MeasuredFloors& measured,
                      const std::optional<Reference>& reference,
                      const std::optional<double>& mean_error) {
  const Plan& plan = context.plan;
  const ExactValues& exact = context.exact;
  const SampledMoments f = sampled_moments(context);
  FloorFacts facts;
  facts.unit_roundoff = plan.fp64() ? 0x1p-53 : 0x1p-24;
  facts.ulps = plan.fp64() ? plan.integrand->ulps_fp64 : plan.integrand->ulps_fp32;
  facts.mean = exact.mean;
  if (!facts.mean && reference) facts.mean = reference->value;
  facts.mean_abs = f.mean_abs;
  if (f.variance) facts.sd = std::sqrt(*f.variance);
  facts.variation = exact.variation;
  facts.dim = plan.cell.scene.dim;
  facts.coordinate_bits = plan.coordinate_bits;
  const Sampler& sampler = *plan.sampler;
  // Base-2 nets and lattices are on the grid.
  facts.truncated = !sampler.centred && !declares(sampler.properties, "digital-net") &&
                    !declares(sampler.properties, "rank-1-lattice");
  facts.periodic = plan.integrand->periodic;
  facts.ode = solves_ode(context);
  facts.discrete_mean = exact.discrete_mean;
  facts.mean_error = mean_error;
  const double scale = sampled_scale(context).value_or(std::fabs(facts.mean.value_or(0)));
  add_summation(context, n, scale, facts);
  if (reference) facts.reference = reference->error;
  return predict_floors(facts, measured);
}

}  // namespace koksma
