#include "quality/koksma_hlawka.hpp"

#include <fmt/format.h>

#include <cmath>

namespace koksma {

KoksmaHlawka koksma_hlawka(const Catalog& catalog, Device& device, const Cell& cell,
                           const Quality& quality, const std::string& directions_file) {
  Device exact_device = Device::choose_exact(device);
  PreparedCell prepared(catalog, device, exact_device,
                        make_plan(catalog, cell, device.facts(), directions_file));
  const ExactSource& source = prepared.plan().integrand->variation;
  KoksmaHlawka result;
  result.scene = cell.scene;
  result.variation = prepared.exact().variation;
  result.variation_source = source.source;
  if (!result.variation)
    result.variation_source = source.kind == ExactSource::Kind::formula
                                  ? "undefined or infinite for these parameters"
                                  : fmt::format("'{}' declares no variation", cell.scene.integrand);
  const Measure& star = quality.measure("star_upper");
  if (!result.variation)
    result.bound_reason = "the variation is unknown";
  else if (!star.value)
    result.bound_reason = "D* has no upper bound here";
  else
    result.bound = *result.variation * *star.value;
  const double estimate = prepared.run_row(cell.n.back()).estimates.front();
  if (!prepared.exact().mean)
    result.error_reason = "the exact mean is unknown";
  else if (!std::isfinite(estimate))
    result.error_reason = "a sample is not finite";
  else
    result.error = std::fabs(estimate - *prepared.exact().mean);
  return result;
}

}  // namespace koksma
