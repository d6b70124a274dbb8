// The cases of `koksma stability`: what entries list, what is demanded of them, and what the suite
// concludes from their outcomes.
#include "stability/suite.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "error/error.hpp"
#include "stability/gap.hpp"
#include "stability/suite_run.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

CellResult result_with(std::string_view verdict, std::optional<double> bias = std::nullopt) {
  CellResult result;
  result.exact.mean = 2;
  result.stability.verdict = verdict;
  if (bias) {
    result.ode = OdeReport{};
    result.ode->integrator_bias = *bias;
  }
  return result;
}

std::vector<std::string> faults_of(const Demand& demand, const CellResult& result,
                                   std::optional<double> digits = std::nullopt) {
  CaseOutcome outcome;
  outcome.verdict = result.stability.verdict;
  outcome.digits = digits;
  return unmet(demand, outcome, result);
}

CaseOutcome with_floors(std::optional<double> predicted, std::optional<double> seen) {
  CaseOutcome outcome;
  outcome.cell = {{"scene", {{"text", "f:d=1"}}}, {"sampler", "sobol"}, {"precision", "fp32"}};
  outcome.floor_predicted = predicted;
  outcome.floor_seen = seen;
  return outcome;
}

}  // namespace

TEST_CASE("every case of every entry is a cell that can be planned", "[unit]") {
  const Suite suite = full_suite(test::catalog());
  std::size_t listed = 0;
  for (const Integrand& f : test::catalog().integrands) listed += f.stability.size();
  CHECK(suite.study.cells.size() == listed);
  REQUIRE(suite.demands.size() == listed);
  for (std::size_t i = 0; i < listed; ++i) {
    REQUIRE(suite.demands[i]);
    CHECK(!suite.demands[i]->note.empty());
    CHECK(suite.study.cells[i].precision);
  }
}

TEST_CASE("a scene that is named has its entry's cases and three of no demand", "[unit]") {
  const Catalog& catalog = test::catalog();
  const auto listed = std::find_if(catalog.integrands.begin(), catalog.integrands.end(),
                                   [](const Integrand& f) { return f.stability.size() > 1; });
  REQUIRE(listed != catalog.integrands.end());
  const Suite all = suite_of(catalog, {listed->name});
  CHECK(all.study.cells.size() == listed->stability.size() + 3);
  CHECK(!all.demands.back());
  const std::string scene =
      scene_of(*listed, listed->stability[0]["d"], listed->stability[0]["parameters"]).text;
  const Suite one = suite_of(catalog, {scene});
  CHECK(one.study.cells.size() >= 4);
  for (const Cell& cell : one.study.cells) CHECK(cell.scene.text == scene);
  CHECK(suite_of(catalog, {"exp-sum:d=3,power=2"}).study.cells.size() == 3);
  CHECK_THROWS_AS(suite_of(catalog, {"exp-sums"}), InputError);
}

TEST_CASE("a demand names what is not met", "[unit]") {
  const Demand plain{"OK", false, "", {}, {}, ""};
  CHECK(faults_of(plain, result_with("OK")).empty());
  CHECK(faults_of(plain, result_with("BIASED")).size() == 1);
  CHECK(faults_of(plain, result_with("")).size() == 1);
  CellResult marked = result_with("OK");
  marked.stability.marks = {"OVERFLOW"};
  CHECK(faults_of(plain, marked).size() == 1);
  const Demand overflow{"OK", true, "", {}, {}, ""};
  CHECK(faults_of(overflow, marked).empty());
  CHECK(faults_of(overflow, result_with("OK")).size() == 1);
  // Relative to the mean, which is 2.
  const Demand biased{"OK", false, "", Interval{0.009, 0.011}, {}, ""};
  CHECK(faults_of(biased, result_with("OK", 0.02)).empty());
  CHECK(faults_of(biased, result_with("OK", 0.01)).size() == 1);
  CHECK(faults_of(biased, result_with("OK", -0.02)).size() == 1);
  CHECK(faults_of(biased, result_with("OK")).size() == 1);
  const Demand accurate{"OK", false, "", {}, Interval{6, 9}, ""};
  CHECK(faults_of(accurate, result_with("OK"), 7).empty());
  CHECK(faults_of(accurate, result_with("OK"), 5).size() == 1);
  CHECK(faults_of(accurate, result_with("OK")).size() == 1);
}

TEST_CASE("floors are within a factor of ten, or are exceptions; those not reached do not count",
          "[unit]") {
  const auto comparison = compare_floors(
      {with_floors(1e-8, 9e-8), with_floors(1e-8, 1.1e-9), with_floors(1e-8, 2e-7),
       with_floors(1e-8, 9e-10), with_floors(1e-8, std::nullopt), with_floors(std::nullopt, 1e-8)});
  CHECK(comparison.reached == 4);
  CHECK(comparison.within_ten == 2);
  CHECK(comparison.exceptions.size() == 2);
}

TEST_CASE("a difference keeps what replicates share and averages out the rest", "[unit]") {
  const Difference shared = difference_of({1.5, 1.5, 1.5, 1.5}, {1, 1, 1, 1}, 256);
  CHECK(shared.mean == 0.5);
  CHECK(shared.sd == 0);
  CHECK(shared.rms_at(1 << 20) == 0.5);
  // +1 and -1: no common part, and a random one of sd sqrt(4/3) that falls as N^-1/2.
  const Difference random = difference_of({1, -1, 1, -1}, {0, 0, 0, 0}, 256);
  CHECK(random.mean == 0);
  CHECK(random.rms_at(256) == Approx(std::sqrt(4.0 / 3)));
  CHECK(random.rms_at(4096) == Approx(std::sqrt(4.0 / 3) / 4));
  const Difference single = difference_of({3}, {1}, 16);
  CHECK(single.rms_at(64) == 2);
}

TEST_CASE("what fp32 loses, fp64 is expected to lose at 2^-29 of it", "[unit]") {
  GapMeasurement gap;
  gap.evaluation = {0x1p-24, 0, 4, 256};
  gap.coordinates = {0x1p-20, 0, 4, 256};
  const MeasuredFloors narrow = floors_from(gap, Precision::fp32, 256);
  CHECK(*narrow.integrand == 0x1p-24);
  CHECK(*narrow.coordinate == 0x1p-20);
  const MeasuredFloors wide = floors_from(gap, Precision::fp64, 256);
  CHECK(*wide.integrand == 0x1p-53);
  CHECK(!wide.coordinate);
  gap.reason = "none";
  CHECK(!floors_from(gap, Precision::fp32, 256).integrand);
}
