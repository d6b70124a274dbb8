#include "estimate/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "estimate/convergence.hpp"

namespace koksma {

std::vector<std::size_t> by_promise(const Catalog& catalog, std::span<const Cell> cells,
                                    std::vector<std::size_t> candidates) {
  const auto promise = [&](std::size_t index) {
    const Cell& cell = cells[index];
    const Sampler sampler = catalog.sampler(cell.sampler, "sampler");
    const Estimator& estimator = catalog.estimator(cell.estimator, "estimator");
    const Integrand& f = catalog.integrand(cell.scene.integrand, "scene");
    const auto rate = f.expected.find(rate_class(sampler, estimator));
    const double slope = rate == f.expected.end()
                             ? 0
                             : expected_slope(rate->second, cell.scene.parameters, cell.scene.dim);
    const double samples =
        static_cast<double>(cell.n.back()) * cell.replicates * estimator.replicates_per_estimate;
    return std::tuple(!estimator.replicated, cell.precision == Precision::fp32, slope, -samples);
  };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](std::size_t a, std::size_t b) { return promise(a) < promise(b); });
  return candidates;
}

std::optional<Reference> reference_from(const Json& cell) {
  if (cell["status"] != "ok" || cell["rows"].empty()) return std::nullopt;
  const Json& row = cell["rows"].back();
  if (!row["estimate"].is_number()) return std::nullopt;
  Reference result;
  result.value = row["estimate"];
  if (row["standard_error"].is_number())
    result.standard_error = row["standard_error"].get<double>();
  result.from =
      fmt::format("{} with {}, N = {}, {} replicate{}", cell["sampler"].get<std::string>(),
                  cell["estimator"].get<std::string>(), row["n"].get<std::uint64_t>(),
                  cell["replicates"].get<std::uint32_t>(), cell["replicates"] == 1 ? "" : "s");
  return result;
}

}  // namespace koksma
