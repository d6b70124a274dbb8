#include "stability/suite_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "device/check_integrand.hpp"
#include "error/error.hpp"
#include "estimate/measure.hpp"
#include "journal/cell_json.hpp"

namespace koksma {
namespace {

// An error is near a floor below so many formula estimates of it, which may be a hundred times too
// low or high; above, measuring it would change nothing.
constexpr double kNearFloor = 1e4;
constexpr double kWithin = 10;  // of estimated and seen floors
// Relative sampling error of a case whose integrator bias is demanded, at the most; 0.7 % is
// measured.
constexpr double kSampled = 0.01;

bool has_verdict(const CellResult& result, std::initializer_list<std::string_view> verdicts) {
  return std::find(verdicts.begin(), verdicts.end(), result.stability.verdict) != verdicts.end();
}

// Are its floors known without the errors of its own rows?
bool predicts(const CellResult& result) {
  return !result.ode || result.exact.discrete_mean || result.detail.floors.integrator;
}

// A cell whose errors mean something.
bool measurable(const CellResult& result) {
  return !has_verdict(result,
                      {"NOT_INTEGRABLE", "UNSTABLE_INTEGRATOR", "DOMAIN_FAULT", "UNRESOLVED"});
}

// Does its error end near where a floor may be? A curve that ends flat does, wherever formulas see
// the floor.
bool near_floor(const CellResult& result) {
  const auto& rmse = result.rows.back().errors.rmse;
  return rmse &&
         (*rmse < kNearFloor * result.floor || result.rate.plateau.kind != PlateauKind::none ||
          result.cell.precision == Precision::fp32);
}

// Where the error stands: of the sampling, or what holds it.
std::string dominating(const CellResult& result) {
  if (has_verdict(result, {"NOT_INTEGRABLE"})) return "no mean";
  if (has_verdict(result, {"UNSTABLE_INTEGRATOR"})) return "integrator";
  if (has_verdict(result, {"DOMAIN_FAULT"})) return "domain";
  const auto& rmse = result.rows.back().errors.rmse;
  if (!rmse || *rmse == 0) return rmse ? "nothing: exact" : "sampling";
  if (has_verdict(result, {"PLATEAU_STRUCTURAL"})) return "the points";
  const std::string_view floor = result.floors.dominant();
  const bool held = *rmse < kFloorFactor * result.floor || has_verdict(result, {"PLATEAU_NUMERIC"});
  return held && !floor.empty() ? std::string(floor) : "sampling";
}

std::optional<double> relative_digits(const CellResult& result) {
  const auto& rmse = result.rows.back().errors.rmse;
  if (!rmse || !(*rmse > 0) || !result.exact.mean || has_verdict(result, {"UNRESOLVED"}))
    return std::nullopt;
  const double scale =
      *result.exact.mean != 0 ? std::fabs(*result.exact.mean) : result.exact.mean_abs.value_or(1.0);
  if (!(*rmse < scale)) return std::nullopt;  // no digit of it is right
  return -std::log10(*rmse / scale);
}

class CaseRunner {
 public:
  CaseRunner(const Catalog& catalog, Device& device, Device& exact_device, std::size_t rows,
             const SuiteOptions& options)
      : catalog_(catalog),
        device_(device),
        exact_device_(exact_device),
        rows_(rows),
        options_(options),
        self_test_(catalog, device) {}

  CaseOutcome run(const Cell& cell, const std::optional<Demand>& demand) {
    CaseOutcome outcome;
    outcome.demand = demand;
    CellResult result;
    try {
      PlanOptions with_counters;
      with_counters.counters = true;
      if (catalog_.integrand(cell.scene.integrand, "scene").users_own)
        check_user_integrand(catalog_, device_, exact_device_, cell);
      Plan plan = make_plan(catalog_, cell, device_.facts(), "", with_counters);
      self_test_.require(plan);
      PreparedCell prepared(catalog_, device_, exact_device_, std::move(plan));
      result = prepared.run(rows_);
      add_detail(prepared, result);
      outcome.cell = cell_to_json(catalog_, result, &prepared.plan());
      describe(result, outcome);
      if (options_.fast_math) outcome.relaxed = against_relaxed(cell, result);
    } catch (const UnsupportedError& error) {
      refuse(cell, CellStatus::unsupported, error.what(), outcome);
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& error) {
      refuse(cell, CellStatus::failed, error.what(), outcome);
    }
    return outcome;
  }

 private:
  void refuse(const Cell& cell, CellStatus status, const std::string& reason,
              CaseOutcome& outcome) {
    outcome.cell = cell_to_json(catalog_, refused_cell(cell, status, reason), nullptr);
    if (status == CellStatus::unsupported && beyond_device(cell, device_.facts()))
      outcome.demand.reset();
    // A demand that could not be tried is not met; a failure is one without any.
    if (outcome.demand || status == CellStatus::failed) outcome.faults.push_back(reason);
  }

  void add_detail(PreparedCell& prepared, CellResult& result) {
    if (options_.checks != nullptr) add_checks(*options_.checks, result);
    result.detail.reproducibility = over_launches(prepared);
    if (measurable(result)) {
      const bool ode = result.ode && !result.exact.discrete_mean;
      if (ode || near_floor(result)) measure_floors(prepared, result, ode);
    }
    assess_cell(prepared.context(), std::nullopt, rows_, result);
  }

  // The kernel that passes indices on is the cell's own, whatever it integrates.
  static void add_checks(const DeviceChecks& checks, CellResult& result) {
    const IndexChecks& indices = checks.indices;
    if (!indices.checks.empty())
      result.detail.index = IndexFlags{indices.sums_ok(), indices.squares_ok(), indices.xors_ok()};
    result.detail.eft_selftest = checks.eft_ok;
  }

  // At the middle of the curve, of other replicates: what is seen at its end is predicted, not
  // repeated.
  void measure_floors(PreparedCell& prepared, CellResult& result, bool ode) {
    Cell cell = prepared.plan().cell;
    ++cell.seed;  // other randomizations than those of the rows
    const std::uint64_t middle = cell.n[cell.n.size() / 2];
    const GapMeasurement gap = measure_gap(catalog_, device_, exact_device_, cell, middle);
    result.detail.floors = floors_from(gap, prepared.plan().precision, cell.n.back());
    if (gap.reason.empty()) {
      result.detail.precision_gap = PrecisionGap{};
      result.detail.precision_gap->difference = gap.total.mean;
      if (gap.rmse64 && *gap.rmse64 > 0)
        result.detail.precision_gap->in_rmse64 = gap.total.mean / *gap.rmse64;
    }
    if (ode)
      result.detail.floors.integrator =
          measure_integrator(catalog_, device_, exact_device_, cell, middle);
    // A running sum's error grows with N, so it is measured at the end.
    const auto sum = measure_summation(catalog_, device_, exact_device_, cell, cell.n.back());
    if (sum) result.detail.floors.summation = sum->rms_at(cell.n.back());
  }

  // The same replicate summed in blocks of other lengths, in one launch and in two, by the same
  // program. Nothing of a sum that is not finite.
  static std::optional<Reproducibility> over_launches(PreparedCell& prepared) {
    const Plan& plan = prepared.plan();
    const std::uint64_t n = plan.cell.n.front();
    const std::uint32_t usual = prepared.integrator().log2_block(n);
    std::vector<double> values;
    for (const std::uint32_t log2_block :
         {usual, std::max(usual, 5U) - 1, std::max(usual, 6U) - 2}) {
      const std::uint64_t blocks = ((n - 1) >> log2_block) + 1;
      for (const std::uint64_t cut : {blocks, blocks / 2}) {
        ExactSum sum;
        const auto take = [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
          if (word < plan.sum_words()) sum.add(partials, plan.word_exponent(word));
        };
        prepared.integrator().run_blocks(n, log2_block, 0, cut, 1, 0.0, take);
        prepared.integrator().run_blocks(n, log2_block, cut, blocks, 1, 0.0, take);
        values.push_back(sum.rounded_quotient(n));
        if (!std::isfinite(values.back())) return std::nullopt;
      }
    }
    Reproducibility found;
    found.launch_shapes = values.size();
    std::sort(values.begin(), values.end());
    const double largest = std::max(std::fabs(values.front()), std::fabs(values.back()));
    const double spread = values.back() - values.front();
    values.erase(std::unique(values.begin(), values.end()), values.end());
    found.distinct_sums = values.size();
    const auto narrow = static_cast<float>(largest);
    const double unit = plan.fp64()
                            ? std::nextafter(largest, INFINITY) - largest
                            : static_cast<double>(std::nextafter(narrow, INFINITY)) - narrow;
    found.ulp_spread = spread / unit;
    return found;
  }

  void describe(const CellResult& result, CaseOutcome& outcome) const {
    outcome.verdict = result.stability.verdict;
    outcome.digits = relative_digits(result);
    outcome.dominates = dominating(result);
    if (measurable(result) && predicts(result)) {
      outcome.floor_predicted = result.floors.predicted_total();
      if (const Floor* floor = result.floors.dominant_floor()) outcome.floor_bound = floor->bound;
    }
    const auto& rmse = result.rows.back().errors.rmse;
    const bool known = outcome.demand && !outcome.demand->held_by.empty();
    const bool expected = outcome.demand && outcome.demand->verdict == "PLATEAU_NUMERIC";
    const PlateauKind end = result.rate.plateau.kind;
    if (end == PlateauKind::numeric || (expected && end != PlateauKind::none))
      outcome.floor_seen = result.rate.plateau.slope > kFlatSlope && rmse
                               ? *rmse  // one that rises has no level
                               : result.rate.plateau.level;
    else if (known && rmse)
      outcome.floor_seen = *rmse;
    if (known) outcome.dominates = fmt::format("{}, as its entry says", outcome.demand->held_by);
    if (outcome.demand) outcome.faults = unmet(*outcome.demand, outcome, result);
  }

  RelaxedDifference against_relaxed(const Cell& cell, const CellResult& strict) {
    RelaxedDifference found;
    try {
      PlanOptions options;
      options.relaxed_math = true;
      Cell last = cell;
      last.n = {strict.rows.back().n};
      Plan plan = make_plan(catalog_, last, device_.facts(), "", options);
      self_test_.require(plan);
      PreparedCell prepared(catalog_, device_, exact_device_, std::move(plan));
      const Row row = prepared.run_row(last.n.front());
      for (std::size_t r = 0; r < row.estimates.size(); ++r)
        found.difference += (row.estimates[r] - strict.rows.back().estimates[r]) /
                            static_cast<double>(row.estimates.size());
      if (!std::isfinite(found.difference)) {
        found.reason = "a sum is not finite";
      } else if (const auto& rmse = strict.rows.back().errors.rmse; rmse && *rmse > 0) {
        found.in_rmse = found.difference / *rmse;
      }
    } catch (const UnsupportedError& error) {
      found.reason = error.what();
    }
    return found;
  }

  const Catalog& catalog_;
  Device& device_;
  Device& exact_device_;
  std::size_t rows_;
  const SuiteOptions& options_;
  EftSelfTest self_test_;
};

void check_range(const std::optional<Interval>& range, const std::optional<double>& value,
                 const char* what, std::vector<std::string>& faults) {
  if (!range || (value && *value >= range->low && *value <= range->high)) return;
  faults.push_back(fmt::format("{} {}, must be {:.4g} to {:.4g}", what,
                               value ? fmt::format("{:.4g}", *value) : "unknown", range->low,
                               range->high));
}

}  // namespace

bool beyond_device(const Cell& cell, const DeviceFacts& device) {
  return cell.precision == Precision::fp64 && !device.fp64;
}

std::vector<std::string> unmet(const Demand& demand, const CaseOutcome& outcome,
                               const CellResult& result) {
  std::vector<std::string> faults;
  if (outcome.verdict != demand.verdict)
    faults.push_back(fmt::format("verdict {}, must be {}: {}",
                                 outcome.verdict.empty() ? "none" : outcome.verdict, demand.verdict,
                                 result.stability.reason));
  const auto& marks = result.stability.marks;
  const bool overflow = std::find(marks.begin(), marks.end(), "OVERFLOW") != marks.end();
  if (overflow != demand.overflow)
    faults.push_back(fmt::format("{}marked OVERFLOW", overflow ? "" : "not "));
  const auto bias =
      result.ode ? result.ode->relative_bias(result.exact.mean) : std::optional<double>();
  // The bias is of closed forms; this is what says that the kernel samples the same solution.
  if (demand.bias && result.ode && result.exact.discrete_mean &&
      !(result.ode->sampling_rmse &&
        *result.ode->sampling_rmse <= kSampled * std::fabs(*result.exact.discrete_mean)))
    faults.emplace_back("the samples are not those of the discrete reference");
  check_range(demand.bias, bias, "relative bias of the integrator", faults);
  check_range(demand.digits, outcome.digits, "digits", faults);
  return faults;
}

std::vector<CaseOutcome> run_suite(const Catalog& catalog, Device& device, Device& exact_device,
                                   const Suite& suite, const SuiteOptions& options) {
  std::size_t rows = 0;
  for (const Cell& cell : suite.study.cells) rows += cell.n.size();
  CaseRunner runner(catalog, device, exact_device, rows, options);
  std::vector<CaseOutcome> outcomes;
  for (std::size_t i = 0; i < suite.study.cells.size(); ++i) {
    outcomes.push_back(runner.run(suite.study.cells[i], suite.demands[i]));
    if (options.progress) options.progress(i, outcomes.back());
  }
  return outcomes;
}

FloorComparison compare_floors(const std::vector<CaseOutcome>& outcomes) {
  FloorComparison comparison;
  for (const CaseOutcome& outcome : outcomes) {
    if (!outcome.floor_seen || !outcome.floor_predicted) continue;
    ++comparison.reached;
    const double ratio = *outcome.floor_predicted / *outcome.floor_seen;
    if (ratio <= kWithin && ratio >= 1 / kWithin) {
      ++comparison.within_ten;
    } else {
      comparison.exceptions.push_back(fmt::format("{} with {} in {}: predicted {:.2g}, seen {:.2g}",
                                                  outcome.cell["scene"]["text"].get<std::string>(),
                                                  outcome.cell["sampler"].get<std::string>(),
                                                  outcome.cell["precision"].get<std::string>(),
                                                  *outcome.floor_predicted, *outcome.floor_seen));
    }
  }
  return comparison;
}

}  // namespace koksma
