// Whatever the replicates of a cell are, what is concluded from them keeps to the rules of page 5,
// section 0: nothing that is not finite is averaged, no rate is fitted through a floor, no error bar
// stands on an unresolved sample, verdicts keep their order, and all of it is valid JSON. Thousands of
// cells are made up at random (fixed seeds), with faults planted anywhere; what must follow is told
// from what was planted, not from what was concluded.
#include <fmt/format.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "estimate/assess.hpp"
#include "journal/cell_json.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "tests/support.hpp"

namespace koksma {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  bool one_in(unsigned n) { return index(n) == 0; }
  std::size_t index(std::size_t n) { return std::size_t{engine_()} % n; }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  // Log-uniform over these powers of ten.
  double size(double low, double high) { return std::pow(10, uniform(low, high)); }
  double normal() { return normal_(engine_); }
  double bad() {
    const std::array values{std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity};
    return values[index(values.size())];
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

// A random cell, and what was planted in it.
struct Made {
  Plan plan;
  Integrand integrand;
  ExactValues exact;
  Kurtosis kurtosis;
  CellResult result;
  std::size_t bad_replicates = 0;         // in all rows
  std::vector<bool> bad_row, zero_row;    // all Q_r = 0
  bool blown_up = false;                  // a mean or a counted sample above 10 times the bound
  bool out_of_range = false, index_fault = false;

  CellContext context() const { return {plan, exact, kurtosis}; }
};

// Plans of several estimators, made once.
const std::vector<Plan>& plans() {
  static const std::vector<Plan> made = [] {
    std::vector<Plan> list;
    for (const auto& [sampler, estimator] :
         {std::pair{"random", "mc"}, {"sobol-owen", "rqmc"}, {"sobol-lms-shift", "median"},
          {"sobol", "qmc"}, {"halton", "qmc"}, {"random-antithetic", ""}}) {
      for (const Precision precision : {Precision::fp32, Precision::fp64}) {
        Cell cell = test::cell("linear-prod:d=2", sampler, 256,
                               std::string(sampler).starts_with("s") ||
                                       std::string(sampler).starts_with("r")
                                   ? 2
                                   : 1,
                               estimator);
        cell.precision = precision;
        list.push_back(make_plan(test::catalog(), cell, {}));
      }
    }
    return list;
  }();
  return made;
}

void draw_exact(Dice& dice, bool ode, ExactValues& exact) {
  const double scale = dice.size(-12, 12);
  if (!dice.one_in(12)) exact.mean = dice.one_in(8) ? 0.0 : scale * dice.uniform(-1, 1);
  if (dice.one_in(3) && exact.mean) exact.mean = std::fabs(*exact.mean);
  if (!dice.one_in(6))
    exact.mean_abs = exact.mean && dice.one_in(2) ? std::fabs(*exact.mean) : scale * dice.size(0, 2);
  if (dice.one_in(10)) {
    exact.infinite_variance = true;
  } else if (dice.one_in(12)) {
    exact.variance_overflows = true;
  } else if (!dice.one_in(6)) {
    exact.variance = dice.one_in(8) ? 0.0 : std::pow(scale * dice.size(-3, 3), 2);
  }
  if (dice.one_in(15)) {
    exact.mean_undefined = true;
    exact.mean.reset();
  }
  if (!ode) return;
  if (dice.one_in(2)) {
    exact.discrete_mean = exact.mean.value_or(scale) * dice.size(-1, 2);
    exact.discrete_mean_abs = std::fabs(*exact.discrete_mean);
    exact.discrete_variance = std::pow(scale * dice.size(-3, 3), 2);
  }
  exact.discrete_overflows = dice.one_in(8);
  if (dice.one_in(2)) exact.bound = scale * dice.size(0, 3);
  if (dice.one_in(2)) exact.stiffness = dice.size(-2, 6);
}

// One estimate of N samples.
struct Law {
  double centre = 0, size = 1, rate = -0.5, floor = 0;
};

std::vector<double> draw_estimates(Dice& dice, const Law& law, std::uint64_t n,
                                   std::size_t count) {
  std::vector<double> estimates;
  for (std::size_t r = 0; r < count; ++r)
    estimates.push_back(law.centre +
                        law.size * std::pow(static_cast<double>(n), law.rate) * dice.normal() +
                        law.floor * dice.normal());
  return estimates;
}

void draw_counters(Dice& dice, const std::vector<double>& estimates, bool bad, Made& made,
                   Row& row) {
  Counters k;
  k.samples = row.n * estimates.size();
  for (const double q : estimates) {
    if (std::isnan(q)) ++k.nan;
    if (std::isinf(q)) ++(q > 0 ? k.plus_inf : k.minus_inf);
  }
  k.hits = made.zero_row.back() ? 0 : 1 + dice.index(k.samples);
  if (dice.one_in(15)) k.coord_ge1 = 1;
  if (dice.one_in(5)) k.coord_le0 = 1;
  if (dice.one_in(20)) k.blow_ups = 1 + dice.index(100);
  if (!made.zero_row.back() && !bad) {
    k.sum_abs = dice.size(0, 6);
    k.sum_squares = k.sum_abs * k.sum_abs / dice.size(0, 6);
  }
  made.out_of_range = made.out_of_range || k.coord_ge1 > 0 ||
                      (made.plan.sampler->centred && k.coord_le0 > 0);
  made.blown_up = made.blown_up || k.blow_ups > 0;
  row.counters = k;
}

void draw_row(Dice& dice, const Law& law, std::uint64_t n, bool counted, Made& made) {
  Row row;
  row.n = n;
  const std::size_t count = made.plan.launched_replicates();
  std::vector<double> estimates = draw_estimates(dice, law, n, count);
  made.zero_row.push_back(dice.one_in(25));
  if (made.zero_row.back()) estimates.assign(count, 0.0);
  if (dice.one_in(25)) estimates.assign(count, estimates.front());
  bool bad = false;
  if (dice.one_in(25)) {
    bad = true;
    for (std::size_t i = 0, faults = 1 + dice.index(count); i < faults; ++i)
      estimates[dice.index(count)] = dice.bad();
    made.zero_row.back() = false;
  }
  made.bad_row.push_back(bad);
  for (const double q : estimates) {
    if (!std::isfinite(q)) ++made.bad_replicates;
    if (std::isfinite(q) && made.exact.bound && std::fabs(q) > 10 * *made.exact.bound)
      made.blown_up = made.plan.estimator->replicates_per_estimate == 1 || made.blown_up;
  }
  // A sum of finite samples may overflow: then no sample is at fault.
  if (bad && !dice.one_in(4)) row.nonfinite = made.bad_replicates;
  if (counted) draw_counters(dice, estimates, bad, made, row);
  if (counted) row.nonfinite = row.counters->nonfinite();
  std::vector<double> variances;
  if (made.plan.estimator->moments == 2)
    for (std::size_t r = 0; r < count; ++r)
      if (std::isfinite(estimates[r])) variances.push_back(std::pow(law.size * dice.normal(), 2));
  row.kernel.count = row.wall.count = 1;
  row.log2_block = 8;
  assess_row(made.context(), estimates, variances, row);
  made.result.rows.push_back(row);
}

void make(Dice& dice, Made& made) {
  const bool ode = dice.one_in(3);
  made.plan = plans()[dice.index(plans().size())];
  made.integrand = *made.plan.integrand;
  made.integrand.ode_size = ode ? 1 : 0;
  made.plan.integrand = &made.integrand;
  constexpr std::array<std::uint32_t, 4> kReplicates{1, 2, 8, 32};
  made.plan.cell.replicates =
      made.plan.estimator->name == "qmc" ? 1 : kReplicates[dice.index(4)];
  draw_exact(dice, ode, made.exact);
  if (dice.one_in(3)) made.kurtosis.excess = dice.size(-1, 5);
  if (dice.one_in(10)) made.kurtosis.unbounded = "nobody knows the tail";

  Law law;
  const double truth = made.exact.discrete_mean.value_or(made.exact.mean.value_or(1));
  const double scale = made.exact.mean_abs.value_or(std::fabs(truth) + 1e-3);
  law.centre = truth + (dice.one_in(4) ? scale * dice.size(-16, 0) : 0);
  law.size = scale * dice.size(-3, 1);
  law.rate = -dice.uniform(0, 3);
  if (dice.one_in(2)) law.floor = scale * dice.size(-17, -2);
  if (dice.one_in(15)) law.size = law.floor = 0;
  const unsigned first = 4 + static_cast<unsigned>(dice.index(8));
  const unsigned rows = 1 + static_cast<unsigned>(dice.index(11));
  const bool counted = dice.one_in(3);
  for (unsigned m = first; m < first + rows; ++m)
    draw_row(dice, law, (std::uint64_t{1} << m) + (dice.one_in(30) ? 1 : 0), counted, made);

  StabilityDetail& detail = made.result.detail;
  if (dice.one_in(4)) {
    detail.index = IndexFlags{!dice.one_in(20), !dice.one_in(20), !dice.one_in(20)};
    made.index_fault = !detail.index->sum_ok || !detail.index->sum_of_squares_ok ||
                       !detail.index->xor_of_hashes_ok;
  }
  for (std::optional<double>* floor : {&detail.floors.integrator, &detail.floors.coordinate,
                                       &detail.floors.integrand, &detail.floors.summation})
    if (dice.one_in(8)) *floor = dice.one_in(4) ? 0 : scale * dice.size(-18, -1);
  made.result.cell = made.plan.cell;
  made.result.exact = made.exact;
  std::optional<Reference> reference;
  if (dice.one_in(2)) {
    reference = Reference{};
    reference->value = truth;
    if (dice.one_in(2)) reference->error = scale * dice.size(-12, -1);
  }
  assess_cell(made.context(), reference, 100, made.result);
}

// N (E|f|)²/E f² of what is sampled, from the values as they were drawn.
std::optional<double> n_eff(const Made& made, double n) {
  const ExactValues& e = made.exact;
  if (e.infinite_variance) return std::nullopt;
  const bool discrete =
      made.integrand.ode_size > 0 && (e.discrete_mean || e.discrete_overflows);
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
  return std::any_of(json.begin(), json.end(),
                     [](const Json& each) { return each.is_structured() ? has_nan(each)
                                                   : each.is_number_float() &&
                                                         !std::isfinite(each.get<double>()); });
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
    for (const std::uint64_t used : made.result.rate.used)
      CHECK(used != made.result.rows[i].n);
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
    const auto seen = row.counters ? row.counters->n_eff() : std::nullopt;
    const double launched = made.plan.launched_replicates();
    const bool finite = !made.exact.infinite_variance;
    const bool nonnegative = made.exact.mean && made.exact.mean_abs && *made.exact.mean > 0 &&
                             *made.exact.mean == *made.exact.mean_abs &&
                             made.integrand.ode_size == 0;
    const bool missed = made.zero_row[i] && nonnegative;
    const bool unresolved = too_few(n_eff(made, n)) || missed ||
                            (finite && seen && *seen / launched < 29.999);
    const bool pool_unresolved = too_few(n_eff(made, n * static_cast<double>(replicates))) ||
                                 missed || (finite && seen && *seen < 29.999);
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

TEST_CASE("random results: faults, floors, error bars, the order of verdicts and JSON keep to the "
          "rules",
          "[unit][estimate]") {
  constexpr std::size_t kBatches = 30, kBatch = 100;
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
    CHECK(verdicts[verdict] >= 10);
  }
}

TEST_CASE("a sample that is not finite is not averaged, though every sum is",
          "[unit][estimate]") {
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
