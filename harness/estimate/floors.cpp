#include "estimate/floors.hpp"

#include <algorithm>
#include <cmath>

namespace koksma {

namespace {

// E|f|, or where it is unknown its bound sqrt(E f²), or |I|.
std::optional<double> scale_of(const FloorFacts& facts) {
  if (facts.mean_abs) return facts.mean_abs;
  if (facts.mean && facts.sd) return std::hypot(*facts.mean, *facts.sd);
  if (facts.mean) return std::fabs(*facts.mean);
  return std::nullopt;
}

Floor integrator_floor(const FloorFacts& facts) {
  if (!facts.ode) return {0.0, 0.0, "f solves no differential equation"};
  if (facts.discrete_mean && facts.mean) {
    const double bias = std::fabs(*facts.discrete_mean - *facts.mean);
    return {bias, bias, "mean of the numerical solution less that of the true one"};
  }
  if (facts.mean_error)
    return {std::fabs(*facts.mean_error), std::nullopt,
            "mean error of the replicates, the same at half of N"};
  return {std::nullopt, std::nullopt, "the mean of the numerical solution is not known"};
}

Floor coordinate_floor(const FloorFacts& facts) {
  if (!facts.truncated) return {0.0, 0.0, "coordinates are exact or centred"};
  if (facts.periodic) return {0.0, 0.0, "f is periodic"};
  const double half_unit = std::ldexp(1.0, -static_cast<int>(facts.coordinate_bits) - 1);
  Floor floor;
  floor.reason = "coordinates are rounded down";
  if (facts.sd) floor.estimate = half_unit * std::sqrt(12.0 * facts.dim) * *facts.sd;
  if (facts.variation) {
    const double most = half_unit * *facts.variation;
    floor.estimate = std::min(floor.estimate.value_or(most), most);
    floor.bound = 2 * most;  // every coordinate by a whole unit
  }
  if (!floor.estimate) floor.reason += ", but neither variance nor variation of f is known";
  return floor;
}

Floor integrand_floor(const FloorFacts& facts) {
  const auto scale = scale_of(facts);
  if (!scale) return {std::nullopt, std::nullopt, "the size of f is not known"};
  const double unit = facts.unit_roundoff * *scale;
  return {kRoundingFactor * unit, facts.ulps * unit, "rounding of f, typical of the catalog"};
}

void take(Floor& floor, const std::optional<double>& measured) {
  if (!measured) return;
  floor.estimate = *measured;
  floor.reason = "measured";
}

struct Named {
  std::string_view name;
  std::optional<double> estimate;
  const Floor* floor = nullptr;
};

Named largest(const Floors& floors) {
  Named best;
  for (const Named& each : {Named{"integrator", floors.integrator.estimate, &floors.integrator},
                            Named{"coordinate", floors.coordinate.estimate, &floors.coordinate},
                            Named{"integrand", floors.integrand.estimate, &floors.integrand},
                            Named{"summation", floors.summation.estimate, &floors.summation},
                            Named{"reference", floors.reference}}) {
    // A NaN is larger than nothing.
    if (each.estimate && *each.estimate > best.estimate.value_or(0)) best = each;
  }
  return best;
}

}  // namespace

double Floors::predicted_total() const { return largest(*this).estimate.value_or(0); }

std::string_view Floors::dominant() const { return largest(*this).name; }

const Floor* Floors::dominant_floor() const { return largest(*this).floor; }

Floors predict_floors(const FloorFacts& facts, const MeasuredFloors& measured) {
  Floors floors;
  floors.integrator = integrator_floor(facts);
  floors.coordinate = coordinate_floor(facts);
  floors.integrand = integrand_floor(facts);
  floors.summation = {facts.summation, facts.summation_bound, "rounding of the sum"};
  floors.reference = facts.reference;
  take(floors.integrator, measured.integrator);
  take(floors.coordinate, measured.coordinate);
  take(floors.integrand, measured.integrand);
  take(floors.summation, measured.summation);
  floors.summation.estimate = std::max(*floors.summation.estimate, facts.result_rounding);
  return floors;
}

}  // namespace koksma
