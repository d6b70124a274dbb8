#include "estimate/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "estimate/convergence.hpp"

namespace koksma {
namespace {

constexpr double kNormalQuantile = 1.96;  // of a two-sided 95 % interval

double promised_slope(const Integrand& f, const Sampler& sampler, const Estimator& estimator,
                      const Scene& scene) {
  auto rate = f.expected.find(rate_class(sampler, estimator));
  if (rate == f.expected.end()) rate = f.expected.find(sampler.rate_class);
  return rate == f.expected.end() ? 0 : expected_slope(rate->second, scene.parameters, scene.dim);
}

}  // namespace

Reference make_reference(double value, std::optional<double> standard_error,
                         const std::optional<Interval>& interval, std::string from) {
  Reference result{value, standard_error, std::move(from)};
  if (standard_error) return result;
  if (interval) {
    result.error = (interval->high - interval->low) / 2 / kNormalQuantile;
    result.from += "; its error is from its interval";
  } else {
    result.from += "; error of the reference unknown";
  }
  return result;
}

std::vector<std::size_t> by_promise(const Catalog& catalog, std::span<const Cell> cells,
                                    std::vector<std::size_t> candidates) {
  const auto promise = [&](std::size_t index) {
    const Cell& cell = cells[index];
    const Sampler sampler = catalog.sampler(cell.sampler, "sampler");
    const Estimator& estimator = catalog.estimator(cell.estimator, "estimator");
    const Integrand& f = catalog.integrand(cell.scene.integrand, "scene");
    const bool heavy = estimator.interval == "student-t" && declares(sampler.validity, "linear");
    const double samples =
        static_cast<double>(cell.n.back()) * cell.replicates * estimator.replicates_per_estimate;
    return std::tuple(estimator.interval == "none", declares(sampler.validity, "iid"),
                      cell.precision == Precision::fp32,
                      promised_slope(f, sampler, estimator, cell.scene), heavy, -samples);
  };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](std::size_t a, std::size_t b) { return promise(a) < promise(b); });
  return candidates;
}

std::optional<Reference> reference_from(const Json& cell) {
  if (cell["status"] != "ok" || cell["rows"].empty()) return std::nullopt;
  const Json& row = cell["rows"].back();
  if (!row["estimate"].is_number()) return std::nullopt;
  std::optional<double> standard_error;
  if (row["standard_error"].is_number()) standard_error = row["standard_error"].get<double>();
  std::optional<Interval> interval;
  const Json& ends = row["interval"];
  if (ends.is_array() && ends[0].is_number() && ends[1].is_number())
    interval = Interval{ends[0], ends[1]};
  return make_reference(
      row["estimate"], standard_error, interval,
      fmt::format("{} with {}, N = {}, {} replicate{}", cell["sampler"].get<std::string>(),
                  cell["estimator"].get<std::string>(), row["n"].get<std::uint64_t>(),
                  cell["replicates"].get<std::uint32_t>(), cell["replicates"] == 1 ? "" : "s"));
}

}  // namespace koksma
