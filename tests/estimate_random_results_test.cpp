// Whatever the replicates of a cell are, what is concluded from them keeps to the rules of page 5,
// section 0: nothing that is not finite is averaged, no rate is fitted through a floor, no error
// bar stands on an unresolved sample, verdicts keep their order, and all of it is valid JSON.
// Thousands of cells are made up at random (fixed seeds), with faults planted anywhere; what must
// follow is told from what was planted, not from what was concluded.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <vector>

#include "journal/cell_json.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "tests/random_results.hpp"

namespace koksma {
namespace {

using test::Dice;
using test::kInfinity;
using test::Made;
using test::make;
using test::plans;

// N (E|f|)²/E f² of what is sampled, from the values as they were drawn.
std::optional<double> n_eff(const Made& made, double n) {
  const ExactValues& e = made.exact;
  if (e.infinite_variance) return std::nullopt;
  const bool discrete = made.integrand.ode_size > 0 && (e.discrete_mean || e.discrete_overflows);
  if (discrete ? e.discrete_overflows : e.variance_overflows) return 0;
  const auto mean = discrete ? e.discrete_mean : e.mean;
  const auto variance = discrete ? e.discrete_variance : e.variance;
  const auto mean_abs = discrete ? e.discrete_mean_abs : e.mean_abs;
  if (!mean || !variance || !mean_abs || (*mean == 0 && *variance == 0)) return std::nullopt;
  return n * (*mean_abs * *mean_abs) / (*variance + *mean * *mean);
}

bool too_few(const std::optional<double>& effective) { return effective && *effective < 29.999; }

bool has_nan(const Json& json) {
  if (json.is_number_float()) return !std::isfinite(json.get<double>());
  return std::any_of(json.begin(), json.end(), [](const Json& each) {
    return each.is_structured() ? has_nan(each)
                                : each.is_number_float() && !std::isfinite(each.get<double>());
  });
}

void check_nothing_of_a_bad_row(const Row& row) {
  const ErrorStatistics& e = row.errors;
  CHECK(e.nonfinite > 0);
  for (const auto& number : {e.mean, e.sd, e.kurtosis, e.bias, e.rmse, e.rmse_low, e.rmse_high,
                             e.median_abs, e.rho, row.estimate.value, row.estimate.standard_error})
    CHECK_FALSE(number);
  CHECK_FALSE(row.estimate.interval);
  CHECK_FALSE(row.mc_test.applicable);
}

// (i)
void check_faults(const Made& made) {
  for (std::size_t i = 0; i < made.bad_row.size(); ++i) {
    if (!made.bad_row[i]) continue;
    check_nothing_of_a_bad_row(made.result.rows[i]);
    for (const std::uint64_t used : made.result.rate.used) CHECK(used != made.result.rows[i].n);
  }
  const std::string_view verdict = made.result.stability.verdict;
  if (made.bad_replicates > 0)
    CHECK((verdict == "NOT_INTEGRABLE" || verdict == "UNSTABLE_INTEGRATOR" ||
           verdict == "DOMAIN_FAULT"));
}

// (ii)
void check_rate(const Made& made) {
  const CellResult& result = made.result;
  const Plateau& plateau = result.rate.plateau;
  // The integrator's floor may have been told from the rows; it is the same for all N.
  MeasuredFloors floors = result.detail.floors;
  floors.integrator = result.floors.integrator.estimate;
  for (const Row& row : result.rows) {
    const auto& used = result.rate.used;
    if (std::find(used.begin(), used.end(), row.n) == used.end()) continue;
    std::vector<double> errors;
    const double truth = made.exact.mean ? *made.exact.mean : result.reference->value;
    for (const double q : row.estimates) errors.push_back(q - truth);
    const double floor =
        formula_floors(made.context(), row.n, floors, result.reference).predicted_total();
    CHECK(root_mean_square(errors) >= 3 * floor);
    if (result.reference && result.reference->error)
      CHECK(root_mean_square(errors) >= 3 * *result.reference->error);
  }
  if (plateau.kind == PlateauKind::numeric && !result.rate.used.empty())
    CHECK(static_cast<double>(result.rate.used.back()) <
          std::max(static_cast<double>(plateau.from),
                   result.rate.bend ? std::exp2(result.rate.bend->log2_samples) : 0));
  if (result.rate.used.size() < 6) CHECK_FALSE(result.rate.slope);
}

// (iii)
void check_error_bars(const Made& made, const Json& json) {
  const bool pooled = made.plan.estimator->interval == "normal";
  const std::uint64_t replicates = made.plan.cell.replicates;
  for (std::size_t i = 0; i < made.result.rows.size(); ++i) {
    const Row& row = made.result.rows[i];
    const double n = static_cast<double>(row.n);
    const double seen = row.counters ? row.counters->n_eff().value_or(kInfinity) : kInfinity;
    const double launched = made.plan.launched_replicates();
    const bool finite = !made.exact.infinite_variance;
    const bool nonnegative = made.exact.mean && made.exact.mean_abs && *made.exact.mean > 0 &&
                             *made.exact.mean == *made.exact.mean_abs &&
                             made.integrand.ode_size == 0;
    const bool missed = made.zero_row[i] && nonnegative;
    const bool unresolved =
        too_few(n_eff(made, n)) || missed || (finite && seen / launched < 29.999);
    const bool pool_unresolved = too_few(n_eff(made, n * static_cast<double>(replicates))) ||
                                 missed || (finite && seen < 29.999);
    if (unresolved || made.exact.infinite_variance) {
      CHECK_FALSE(row.errors.rmse_low);
      CHECK_FALSE(row.errors.rmse_high);
      for (const char* key : {"rmse_interval", "efficiency", "variance_reduction"})
        CHECK(json["rows"][i][key].is_null());
    }
    if ((pooled ? pool_unresolved : unresolved) || made.exact.infinite_variance ||
        made.exact.mean_undefined) {
      CHECK_FALSE(row.estimate.interval);
      CHECK_FALSE(row.estimate.standard_error);
      CHECK(json["rows"][i]["interval"].is_null());
      CHECK(json["rows"][i]["standard_error"].is_null());
    }
  }
  if (made.result.stability.verdict == "UNRESOLVED")
    CHECK(json["stability"]["error"]["rmse_ci"].is_null());
  if (made.exact.infinite_variance) CHECK_FALSE(made.result.rate.slope);
}

// (iv)
void check_order(const Made& made) {
  const CellResult& result = made.result;
  const bool ode = made.integrand.ode_size > 0;
  const std::string_view verdict = result.stability.verdict;
  const auto seen = result.stability.empirical_n_eff;
  std::string_view expected;
  if (made.exact.mean_undefined) {
    expected = "NOT_INTEGRABLE";
  } else if (ode && (made.bad_replicates > 0 || made.blown_up)) {
    expected = "UNSTABLE_INTEGRATOR";
  } else if (made.bad_replicates > 0 || made.out_of_range || made.index_fault) {
    expected = "DOMAIN_FAULT";
  } else if (too_few(n_eff(made, static_cast<double>(result.rows.back().n))) ||
             (!made.exact.infinite_variance && seen && *seen < 29.999)) {
    expected = "UNRESOLVED";
  }
  if (!expected.empty()) {
    CHECK(verdict == expected);
  } else if (verdict != "UNRESOLVED" && verdict != "UNSTABLE_INTEGRATOR" && !verdict.empty()) {
    const PlateauKind kind = result.rate.plateau.kind;
    CHECK((verdict == "PLATEAU_NUMERIC") == (kind == PlateauKind::numeric));
    CHECK((verdict == "PLATEAU_STRUCTURAL") == (kind == PlateauKind::structural));
  }
  const bool overflows = made.exact.discrete_overflows || made.exact.variance_overflows;
  CHECK(result.stability.marks.empty() == !overflows);
  CHECK((verdict.empty() ? !made.exact.mean : true));
}

}  // namespace

TEST_CASE(
    "random results: faults, floors, error bars, the order of verdicts and JSON keep to the "
    "rules",
    "[unit][estimate]") {
  // Sanitizers look at the code and take ten times as long; the rules are checked without them.
  constexpr std::size_t kBatches = KOKSMA_SANITIZED ? 5 : 30, kBatch = 100;
  Dice dice(5);
  std::map<std::string_view, int> verdicts;
  for (std::size_t b = 0; b < kBatches; ++b) {
    Json cells = Json::array();
    for (std::size_t i = 0; i < kBatch; ++i) {
      Made made;
      make(dice, made);
      INFO("batch " << b << " case " << i << ": " << made.plan.sampler->name << " "
                    << made.result.stability.verdict << ", " << made.result.stability.reason);
      const Json json = cell_to_json(test::catalog(), made.result, &made.plan);
      check_faults(made);
      check_rate(made);
      check_error_bars(made, json);
      check_order(made);
      REQUIRE_FALSE(has_nan(json));
      cells.push_back(json);
      ++verdicts[made.result.stability.verdict];
    }
    Study study;
    study.verbatim = Json::object();
    const Json results = make_results(make_context(DeviceFacts{}, study, "test"), cells);
    REQUIRE_NOTHROW(check_schema(results, "results/results.schema.json", "test"));
    CHECK(Json::parse(results.dump()) == results);
    CHECK_FALSE(results_table(results).empty());
  }
  // Each verdict is among them, or the test would prove less than it says.
  for (const char* verdict : {"NOT_INTEGRABLE", "UNSTABLE_INTEGRATOR", "DOMAIN_FAULT", "UNRESOLVED",
                              "PLATEAU_NUMERIC", "PLATEAU_STRUCTURAL", "BIASED", "OK"}) {
    INFO(verdict);
    CHECK(verdicts[verdict] >= (KOKSMA_SANITIZED ? 1 : 5));
  }
}

TEST_CASE("a sample that is not finite is not averaged, though every sum is", "[unit][estimate]") {
  Made made;
  made.plan = plans().front();
  made.exact.mean = made.exact.mean_abs = made.exact.variance = 1;
  Row row;
  row.n = 1024;
  row.nonfinite = 1;
  const std::vector<double> estimates(made.plan.launched_replicates(), 1.0);
  assess_row(made.context(), estimates, {}, row);
  check_nothing_of_a_bad_row(row);
  made.result.rows.push_back(row);
  assess_cell(made.context(), std::nullopt, 1, made.result);
  CHECK(made.result.stability.verdict == "DOMAIN_FAULT");
}

}  // namespace koksma
