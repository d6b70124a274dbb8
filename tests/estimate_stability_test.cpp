// The verdict on a cell: each one once, their order, and what the bias test does not judge;
// intervals that are taken back; two real cells.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "estimate/measure.hpp"
#include "estimate/stability.hpp"
#include "journal/cell_json.hpp"
#include "report/table.hpp"
#include "tests/support.hpp"

namespace koksma {
namespace {

using Catch::Matchers::Contains;

// Normal replicates about 1 + offset·sd, one of the seeds of which none looks abnormal.
ErrorStatistics normal_errors(double offset, std::size_t replicates = 16, double sd = 1e-3) {
  std::vector<double> estimates;
  for (std::size_t r = 0; r < replicates; ++r) {
    // Quantiles of the logistic distribution stand for normal ones: symmetric, of kurtosis about 3.
    const double p = (static_cast<double>(r) + 0.5) / static_cast<double>(replicates);
    estimates.push_back(1 + sd * (offset + 0.6 * std::log(p / (1 - p))));
  }
  return summarise_errors(estimates, 1.0);
}

// A cell without a fault, within its gate.
CellFacts sound() {
  CellFacts facts;
  facts.mean = 1;
  facts.mean_abs = 1;
  facts.n_eff = 1000;
  facts.errors = normal_errors(0);
  facts.floor = 1e-15;
  facts.rate.verdict = "within-gate";
  return facts;
}

CellFacts biased() {
  CellFacts facts = sound();
  facts.errors = normal_errors(10);
  return facts;
}

Estimate with_interval() {
  Estimate estimate;
  estimate.value = 1;
  estimate.standard_error = 0.1;
  estimate.interval = Interval{0.8, 1.2};
  return estimate;
}

}  // namespace

TEST_CASE("each fault has its verdict, and the first that applies is given", "[unit][estimate]") {
  // All faults at once; one after the other is taken away.
  CellFacts facts = biased();
  facts.rate.verdict = "outside-gate";
  facts.plateau.kind = PlateauKind::structural;
  facts.n_eff = 29.9;
  facts.nonfinite = 3;
  facts.ode = true;
  facts.mean_undefined = true;
  CHECK(decide_verdict(facts, 1).verdict == "NOT_INTEGRABLE");
  facts.mean_undefined = false;
  CHECK(decide_verdict(facts, 1).verdict == "UNSTABLE_INTEGRATOR");
  facts.ode = false;
  CHECK(decide_verdict(facts, 1).verdict == "DOMAIN_FAULT");
  CHECK_THAT(decide_verdict(facts, 1).reason, Contains("3 samples"));
  facts.nonfinite = 0;
  CHECK(decide_verdict(facts, 1).verdict == "UNRESOLVED");
  facts.n_eff = 30;
  CHECK(decide_verdict(facts, 1).verdict == "PLATEAU_STRUCTURAL");
  facts.plateau.kind = PlateauKind::numeric;
  CHECK(decide_verdict(facts, 1).verdict == "PLATEAU_NUMERIC");
  facts.plateau.kind = PlateauKind::none;
  CHECK(decide_verdict(facts, 1).verdict == "BIASED");
  facts.errors = normal_errors(0);
  CHECK(decide_verdict(facts, 1).verdict == "OUTSIDE_GATE");
  facts.rate.verdict = "within-gate";
  const CellVerdict sound_verdict = decide_verdict(facts, 1);
  CHECK(sound_verdict.verdict == "OK");
  CHECK(sound_verdict.reason.empty());
  CHECK(*sound_verdict.n_eff == 30);
  CHECK(std::fabs(*sound_verdict.z_bias) < 1e-9);
}

TEST_CASE("a cell that is not gated is OK and says why it is not", "[unit][estimate]") {
  CellFacts facts = sound();
  facts.rate.verdict = "reported";
  facts.rate.reason = "the dimension is above the gate";
  CHECK(decide_verdict(facts, 1).verdict == "OK");
  CHECK(decide_verdict(facts, 1).reason == "not gated: the dimension is above the gate");
  facts.rate.verdict = "no-theory";
  CHECK(decide_verdict(facts, 1).reason == "not gated: no expected rate");
}

TEST_CASE("without an exact value there is no verdict but the reason", "[unit][estimate]") {
  CellFacts facts = sound();
  facts.mean.reset();
  CHECK(decide_verdict(facts, 1).verdict.empty());
  CHECK(decide_verdict(facts, 1).reason == "no exact value");
  facts.nonfinite = 1;
  CHECK(decide_verdict(facts, 1).verdict == "DOMAIN_FAULT");
}

TEST_CASE("a rare event that was never hit is unresolved, whatever n_eff says",
          "[unit][estimate]") {
  CellFacts facts = sound();
  facts.n_eff.reset();
  facts.errors = summarise_errors(std::vector<double>(8, 0.0), 1.0);
  CHECK(decide_verdict(facts, 1).verdict == "UNRESOLVED");
  // Of an f of both signs 0 is an estimate like any other.
  facts.mean_abs = 2;
  CHECK(decide_verdict(facts, 1).verdict == "OK");
}

TEST_CASE("a row that is excluded as unresolved is no plateau", "[unit][estimate]") {
  CellFacts facts = sound();
  facts.plateau.kind = PlateauKind::structural;
  facts.unresolved_row = "unresolved: RMSE > E|f|/2";
  CHECK(decide_verdict(facts, 1).verdict == "UNRESOLVED");
  CHECK(decide_verdict(facts, 1).reason == "unresolved: RMSE > E|f|/2");
}

TEST_CASE("the bias test shares 1e-6 among the rows of the run", "[unit][estimate]") {
  // t_15 at 1e-6 two-sided is 7.8; at 1e-6 / 10^6 about 21. The offset makes 4 sd of a mean to z =
  // 16 or so.
  CellFacts facts = sound();
  facts.errors = normal_errors(4);
  const double z = *decide_verdict(facts, 1).z_bias;
  CHECK(z > 9);
  CHECK(z < 20);
  CHECK(decide_verdict(facts, 1).verdict == "BIASED");
  CHECK(decide_verdict(facts, 1'000'000).verdict == "OK");
  facts.errors = normal_errors(1.5);
  CHECK(decide_verdict(facts, 1).verdict == "OK");
}

TEST_CASE("a bias within three floors is that of the floor", "[unit][estimate]") {
  CellFacts facts = biased();
  facts.floor = *facts.errors.bias / 2.9;
  CHECK(decide_verdict(facts, 1).verdict == "OK");
  facts.floor_from = "integrator";
  CHECK_THAT(decide_verdict(facts, 1).reason,
             Contains("the bias is that of the floor, integrator"));
  facts.floor = *facts.errors.bias / 3.1;
  CHECK(decide_verdict(facts, 1).verdict == "BIASED");
}

TEST_CASE("no bias is claimed where the mean error has no t distribution", "[unit][estimate]") {
  const auto untested = [](const CellFacts& facts, const std::string& why) {
    INFO(why);
    const CellVerdict verdict = decide_verdict(facts, 1);
    CHECK(verdict.verdict == "OK");
    CHECK(verdict.reason == "bias not tested: " + why);
  };
  CellFacts facts = biased();
  facts.infinite_variance = true;
  untested(facts, "infinite variance");
  CHECK_FALSE(decide_verdict(facts, 1).z_bias);
  facts = biased();
  facts.errors.heavy_tailed = true;
  untested(facts, "heavy-tailed errors");
  facts = biased();
  facts.excess_of_mean = 0.1;
  untested(facts, "excess kurtosis / N is not below 0.1");
  facts.excess_of_mean = 0.09;
  CHECK(decide_verdict(facts, 1).verdict == "BIASED");
  facts.unbounded_tail = "nobody knows the tail";
  untested(facts, "nobody knows the tail");
  facts = biased();
  facts.errors.kurtosis = 9;
  untested(facts, "the errors are not normal");
  facts = sound();
  facts.errors = summarise_errors(std::vector<double>{1.5}, 1.0);
  untested(facts, "one replicate");
  facts.errors = summarise_errors(std::vector<double>(8, 1.5), 1.0);
  untested(facts, "the replicates do not differ");
}

TEST_CASE("independent replicates are no more alike than their exact variance has them",
          "[unit][estimate]") {
  // All replicates missed a spike and so agree on a wrong value.
  CellFacts facts = biased();
  facts.exact_sd = 10e-3;
  CHECK(decide_verdict(facts, 1).verdict == "OK");
  facts.exact_sd = 1e-3;
  CHECK(decide_verdict(facts, 1).verdict == "BIASED");
}

TEST_CASE("infinite variance skips the rule of n_eff", "[unit][estimate]") {
  CellFacts facts = sound();
  facts.n_eff = 1;
  facts.infinite_variance = true;
  CHECK(decide_verdict(facts, 1).verdict == "OK");
}

TEST_CASE("an interval that the samples cannot support is taken back, with the reason",
          "[unit][estimate]") {
  const auto taken_back = [](const IntervalFacts& facts, const std::string& why) {
    Estimate estimate = with_interval();
    qualify_interval(estimate, facts);
    INFO(why);
    CHECK_FALSE(estimate.interval);
    CHECK_FALSE(estimate.standard_error);
    CHECK(estimate.value);
    CHECK(estimate.reason == why);
  };
  IntervalFacts facts;
  facts.unresolved = "n_eff below 30";
  taken_back(facts, "no interval: n_eff below 30");
  facts.infinite_variance = true;
  taken_back(facts, "no interval: the variance is infinite");
  facts.mean_undefined = true;
  taken_back(facts, "no interval: f has no mean");
  // An estimator that has none keeps its own reason.
  Estimate none;
  none.reason = "this estimator has no interval";
  qualify_interval(none, facts);
  CHECK(none.reason == "this estimator has no interval");
}

TEST_CASE("an interval that may not cover stays and says so", "[unit][estimate]") {
  const auto reason_with = [](const IntervalFacts& facts) {
    Estimate estimate = with_interval();
    qualify_interval(estimate, facts);
    CHECK(estimate.interval);
    return estimate.reason;
  };
  IntervalFacts facts;
  facts.excess_of_mean = 0.09;
  CHECK(reason_with(facts).empty());
  facts.excess_of_mean = 0.1;
  CHECK(reason_with(facts) == "may cover less: excess kurtosis / N is not below 0.1");
  facts.excess_of_mean.reset();
  std::vector<double> variances = {1, 1, 1, 2.9};
  facts.variances = variances;
  CHECK(reason_with(facts).empty());
  variances[3] = 3.1;
  CHECK(reason_with(facts) == "may cover less: one replicate holds most of the variance");
  facts.variances = std::span(variances).last(3);
  CHECK(reason_with(facts).empty());
  facts.unbounded_tail = "nobody knows the tail";
  CHECK(reason_with(facts) == "may cover less: nobody knows the tail");
  facts.unbounded_tail.clear();
  facts.heavy_tailed = true;
  CHECK(reason_with(facts) == "may cover more or less: heavy-tailed replicates");
}

TEST_CASE("with infinite variance the median is all that stays of the errors", "[unit][estimate]") {
  ErrorStatistics errors = normal_errors(1);
  REQUIRE(errors.rmse_low);
  drop_rmse(errors);
  CHECK_FALSE(errors.rmse);
  CHECK_FALSE(errors.rmse_low);
  CHECK_FALSE(errors.rmse_high);
  CHECK_FALSE(errors.rho);
  CHECK(errors.rmse_interval_method.empty());
  CHECK(errors.median_abs);
}

TEST_CASE(
    "smooth scenes: nested scrambling in fp64 is OK, a tent lattice in fp32 ends at the floor",
    "[device][estimate]") {
  const CellResult good =
      test::run_sizes("genz-gaussian:d=2", "sobol-owen", "2^8..2^16", 32, Precision::fp64);
  CHECK(good.stability.verdict == "OK");
  CHECK(good.stability.reason.empty());
  CHECK(*good.stability.n_eff > 30);
  CHECK(good.stability.z_bias);

  const CellResult floor = test::run_sizes("genz-oscillatory:d=1", "lattice-shift-tent",
                                           "2^8..2^19", 32, Precision::fp32);
  INFO(floor.stability.reason);
  CHECK(floor.stability.verdict == "PLATEAU_NUMERIC");
  CHECK(floor.rate.plateau.rows >= 4);
  CHECK(floor.rate.plateau.from >= 1U << 12U);
  CHECK(floor.rate.plateau.level < 10 * floor.floor);
}

TEST_CASE("few samples of a peak are unresolved and have no interval", "[device][estimate]") {
  // n_eff = 12/13 N (x + 1/2): 2^4 samples of 1 replicate are too few, 32·2^4 are pooled by mc.
  const CellResult few =
      test::run_sizes("linear-prod:d=1,scale=1,power=0", "sobol-owen", "2^4", 32, Precision::fp64);
  CHECK(few.stability.verdict == "UNRESOLVED");
  CHECK_FALSE(few.rows[0].estimate.interval);
  CHECK(few.rows[0].estimate.reason == "no interval: n_eff below 30");
  const CellResult pooled =
      test::run_sizes("linear-prod:d=1,scale=1,power=0", "random", "2^4", 32, Precision::fp64);
  CHECK(pooled.stability.verdict == "UNRESOLVED");
  CHECK(pooled.rows[0].estimate.interval);
}

TEST_CASE("the table shows the verdict that is not OK, and of infinite variance the median's rate",
          "[device][estimate]") {
  const CellResult result =
      test::run_sizes("genz-gaussian:d=2", "sobol-owen", "2^8..2^13", 32, Precision::fp64);
  Cell cell = result.cell;
  const Plan plan = make_plan(test::catalog(), cell, test::device().facts());
  Json results;
  results["cells"].push_back(cell_to_json(test::catalog(), result, &plan));
  Json& json = results["cells"][0];
  CHECK(json["stability"]["verdict"] == "OK");
  const auto first_cell = [&] {
    const std::string table = results_table(results);
    return table.substr(0, table.find("\n\n"));
  };
  CHECK_THAT(first_cell(), !Contains("OK"));
  json["stability"]["verdict"] = "PLATEAU_STRUCTURAL";
  CHECK_THAT(first_cell(), Contains("PLATEAU_STRUCTURAL") && !Contains("OVERFLOW"));
  json["stability"]["marks"].push_back("OVERFLOW");
  json["stability"]["ode"] = {{"relative_bias", 32.0}};
  CHECK_THAT(first_cell(), Contains("OVERFLOW") && Contains("integrator bias +3.2e+03 %"));
  json["stability"]["verdict"] = "PLATEAU_NUMERIC";
  json["stability"]["floors"]["dominant"] = "integrator";
  CHECK_THAT(first_cell(), Contains("PLATEAU_NUMERIC") && Contains("floor: integrator"));
  json["stability"]["infinite_variance"] = true;
  json["convergence"]["rate"] = nullptr;
  json["convergence"]["median_rate"] = -0.25;
  json["convergence"]["median_interval"] = Json::array({-0.3, -0.2});
  CHECK_THAT(first_cell(),
             Contains("-0.25 ± 0.05") && Contains("infinite variance: rate of the median"));
}

}  // namespace koksma
