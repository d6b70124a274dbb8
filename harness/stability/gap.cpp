#include "stability/gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "error/error.hpp"
#include "estimate/measure.hpp"

namespace koksma {
namespace {

constexpr double kUnitRatio = 0x1p-29;  // of the roundings of fp64 and fp32

Row row_of(const Catalog& catalog, Device& device, Device& exact_device, Cell cell,
           Precision precision, std::uint64_t n, const PlanOptions& options) {
  cell.precision = precision;
  cell.n = {n};
  PreparedCell prepared(catalog, device, exact_device,
                        make_plan(catalog, cell, device.facts(), "", options));
  return prepared.run_row(n);
}

std::vector<double> estimates_of(const Catalog& catalog, Device& device, Device& exact_device,
                                 const Cell& cell, Precision precision, std::uint64_t n) {
  return row_of(catalog, device, exact_device, cell, precision, n, {}).estimates;
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// The sum that rounds nothing.
std::string exact_sum(const Catalog& catalog) {
  for (const SumAlgorithm& s : catalog.sums)
    if (s.order_free && s.bound.empty() && s.quantum == 0) return s.name;
  return "";
}

// The place of the parameter that sets a solver's accuracy: by the contract of solvers
// (kernels/README.md) it is `steps`, or `tolerance` of one that is adaptive.
std::optional<std::size_t> accuracy_parameter(const Integrand& f, const Solver& solver) {
  const char* const wanted = solver.adaptive ? "tolerance" : "steps";
  for (std::size_t i = 0; i < f.parameters.size(); ++i)
    if (f.parameters[i].name == wanted) return i;
  return std::nullopt;
}

// The cell with the tolerance that its solver really takes in this precision.
Cell with_effective_tolerance(const Catalog& catalog, Cell cell, Precision precision) {
  const Integrand& f = catalog.integrand(cell.scene.integrand, "scene");
  const std::string* name = solver_of(f, cell.scene.choices);
  if (name == nullptr) return cell;
  const Solver& solver = catalog.solver(*name);
  const auto place = accuracy_parameter(f, solver);
  if (!solver.adaptive || !place) return cell;
  double& tolerance = cell.scene.parameters[*place];
  tolerance = std::max(tolerance, precision == Precision::fp32 ? solver.least_tolerance_fp32
                                                               : solver.least_tolerance_fp64);
  return cell;
}

}  // namespace

double Difference::rms_at(std::uint64_t samples) const {
  const double random = sd * sd * static_cast<double>(n) / static_cast<double>(samples);
  const double noise = sd * sd / std::max(replicates, 1U);  // of the mean, squared
  return std::sqrt(std::max(mean * mean - noise, 0.0) + random);
}

Difference difference_of(const std::vector<double>& a, const std::vector<double>& b,
                         std::uint64_t n) {
  Difference d;
  d.replicates = static_cast<std::uint32_t>(a.size());
  d.n = n;
  for (std::size_t r = 0; r < a.size(); ++r) d.mean += (a[r] - b[r]) / d.replicates;
  for (std::size_t r = 0; r < a.size() && d.replicates > 1; ++r)
    d.sd += std::pow(a[r] - b[r] - d.mean, 2) / (d.replicates - 1);
  d.sd = std::sqrt(d.sd);
  return d;
}

GapMeasurement measure_gap(const Catalog& catalog, Device& device, Device& exact_device,
                           const Cell& cell, std::uint64_t n) {
  GapMeasurement gap;
  // All at the tolerance of fp32, so that the difference is of rounding alone.
  Cell summed = with_effective_tolerance(catalog, cell, Precision::fp32);
  summed.sum = "";  // the widest the device has
  try {
    const auto run = [&](Precision precision, bool coarse) {
      PlanOptions options;
      options.coarse_coordinates = coarse;
      return row_of(catalog, device, exact_device, summed, precision, n, options);
    };
    const auto narrow = run(Precision::fp32, false).estimates;
    const auto coarse = run(Precision::fp64, true).estimates;
    const Row finest = run(Precision::fp64, false);
    const auto& fine = finest.estimates;
    if (!all_finite(narrow) || !all_finite(coarse) || !all_finite(fine)) {
      gap.reason = "a sum is not finite in one of the precisions";
      return gap;
    }
    gap.evaluation = difference_of(narrow, coarse, n);
    gap.coordinates = difference_of(coarse, fine, n);
    gap.total = difference_of(narrow, fine, n);
    gap.rmse64 = finest.errors.rmse;
  } catch (const UnsupportedError& error) {
    gap.reason = error.what();
  }
  return gap;
}

std::optional<Difference> measure_summation(const Catalog& catalog, Device& device,
                                            Device& exact_device, const Cell& cell,
                                            std::uint64_t n) {
  Cell exact = cell;
  exact.sum = exact_sum(catalog);
  if (exact.sum.empty()) return std::nullopt;
  const Precision precision = cell.precision.value_or(Precision::fp64);
  const auto plain = estimates_of(catalog, device, exact_device, cell, precision, n);
  const auto best = estimates_of(catalog, device, exact_device, exact, precision, n);
  if (!all_finite(plain) || !all_finite(best)) return std::nullopt;
  return difference_of(plain, best, n);
}

std::optional<double> measure_integrator(const Catalog& catalog, Device& device,
                                         Device& exact_device, const Cell& cell, std::uint64_t n) {
  const Integrand& f = catalog.integrand(cell.scene.integrand, "scene");
  const std::string* name = solver_of(f, cell.scene.choices);
  if (name == nullptr) return std::nullopt;
  const Solver& solver = catalog.solver(*name);
  const auto place = accuracy_parameter(f, solver);
  if (!place) return std::nullopt;
  // In the widest precision: what rounds is another term. At the tolerance that the cell's takes.
  const Precision wide = device.facts().fp64 ? Precision::fp64 : Precision::fp32;
  const Cell usual =
      with_effective_tolerance(catalog, cell, cell.precision.value_or(Precision::fp64));
  Cell finer = usual;
  double& value = finer.scene.parameters[*place];
  const double before = value;
  value = solver.adaptive ? value / 10 : 2 * value;
  value = std::clamp(value, f.parameters[*place].min, f.parameters[*place].max);
  if (value == before) return std::nullopt;
  const auto coarse = estimates_of(catalog, device, exact_device, usual, wide, n);
  const auto fine = estimates_of(catalog, device, exact_device, finer, wide, n);
  if (!all_finite(coarse) || !all_finite(fine)) return std::nullopt;
  const double rate = std::exp2(solver.order);
  const double factor = solver.adaptive ? 1 : rate / (rate - 1);
  return factor * difference_of(coarse, fine, n).rms_at(n);
}

MeasuredFloors floors_from(const GapMeasurement& gap, Precision precision, std::uint64_t n) {
  MeasuredFloors floors;
  if (!gap.reason.empty()) return floors;
  const bool wide = precision == Precision::fp64;
  floors.integrand = gap.evaluation.rms_at(n) * (wide ? kUnitRatio : 1);
  // Of 52 bits there is no finer grid to compare with: the formula stays.
  if (!wide) floors.coordinate = gap.coordinates.rms_at(n);
  return floors;
}

}  // namespace koksma
