// The stability suite run on the device: verdicts that named cases must get, what is measured
// beside them against what is known otherwise, and what the verb makes of it.
#include "stability/suite_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "journal/cell_json.hpp"
#include "report/results.hpp"
#include "report/stability_report.hpp"
#include "stability/gap.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// The cases of these integrands; the others would take CI minutes to build.
Suite part_of_suite(const std::set<std::string>& integrands) {
  const Suite all = full_suite(test::catalog());
  Suite part;
  part.study.verbatim = all.study.verbatim;
  for (std::size_t i = 0; i < all.study.cells.size(); ++i) {
    if (integrands.count(all.study.cells[i].scene.integrand) == 0) continue;
    part.study.cells.push_back(all.study.cells[i]);
    part.study.cells.back().launches = 1;  // errors are looked at, not times
    part.demands.push_back(all.demands[i]);
  }
  return part;
}

std::vector<CaseOutcome> outcomes_of(const Suite& suite) {
  return run_suite(test::catalog(), test::device(), test::device(), suite, {});
}

Json report(const std::vector<CaseOutcome>& outcomes) {
  DeviceChecks checks;
  checks.eft_ok = checks.summation.ok = checks.invariance.ok = true;
  checks.indices.ok = checks.denormals.ok = true;
  Study study;
  study.verbatim = Json::object();
  return stability_json(make_context(test::device().facts(), study, "test"), checks, outcomes, 0);
}

Cell ode_cell(const std::string& scene, Precision precision) {
  Cell cell = test::cell(scene, "sobol-owen", 1 << 10, 8);
  cell.precision = precision;
  return cell;
}

}  // namespace

TEST_CASE("cases get the verdicts that they must, and one that does not is told", "[device]") {
  Suite suite = part_of_suite({"dahlquist", "cauchy", "prod-2x", "lattice-alias", "power-sing",
                               "cancel-1mcos", "logistic"});
  REQUIRE(suite.study.cells.size() > 15);
  auto outcomes = outcomes_of(suite);
  std::set<std::string> verdicts;
  for (const CaseOutcome& outcome : outcomes) {
    INFO(outcome.cell["scene"]["text"] << ": " << outcome.verdict);
    for (const std::string& fault : outcome.faults) FAIL_CHECK(fault);
    verdicts.insert(outcome.verdict);
  }
  CHECK(verdicts.size() >= 7);
  CHECK(all_met(report(outcomes)));
  // The rounding that no wider precision tells of is listed, not left out.
  const FloorComparison floors = compare_floors(outcomes);
  CHECK(floors.reached > floors.within_ten);
  CHECK(floors.exceptions.size() == floors.reached - floors.within_ten);

  const auto unstable = std::find_if(outcomes.begin(), outcomes.end(), [](const CaseOutcome& o) {
    return o.verdict == "UNSTABLE_INTEGRATOR";
  });
  REQUIRE(unstable != outcomes.end());
  CHECK(unstable->cell["stability"]["ode"]["blow_ups"].get<std::uint64_t>() > 0);
  CHECK(unstable->cell["stability"]["ode"]["max_abs_r"].get<double>() > 1);
  CHECK(!unstable->floor_predicted);
  // Another demand, and it is not met.
  const auto place = static_cast<std::size_t>(unstable - outcomes.begin());
  Suite wrong;
  wrong.study.verbatim = suite.study.verbatim;
  wrong.study.cells = {suite.study.cells[place]};
  wrong.demands = {suite.demands[place]};
  wrong.demands[0]->verdict = "OK";
  const Json json = report(outcomes_of(wrong));
  CHECK(!all_met(json));
  CHECK(json["cases"][0]["met"] == false);
  CHECK(stability_table(json).find("must be OK") != std::string::npos);

  // What nobody demands and the device can not do is told with its reason, and is no failure.
  CaseOutcome untried;
  untried.cell = cell_to_json(
      test::catalog(), refused_cell(wrong.study.cells[0], CellStatus::unsupported, "it lacks that"),
      nullptr);
  const Json untold = report({untried, untried});
  CHECK(all_met(untold));
  CHECK(stability_table(untold).find("not tried, unsupported, 2: it lacks that\n") !=
        std::string::npos);
}

TEST_CASE("nothing is demanded in fp64 of a device that lacks it, and only then", "[unit]") {
  Cell cell;
  DeviceFacts device;
  for (const bool has : {true, false}) {
    device.fp64 = has;
    cell.precision = Precision::fp64;
    CHECK(beyond_device(cell, device) == !has);
    cell.precision = Precision::fp32;
    CHECK(!beyond_device(cell, device));
  }
}

TEST_CASE("the integrator's bias by finer steps is that of the closed form", "[device]") {
  // rate = 100: h lambda to 1, so no layer is missed and the order is seen.
  for (const auto& [solver, within] :
       {std::pair{"backward-euler", 0.1}, {"trapezoid", 0.1}, {"sdirk2", 0.1}}) {
    INFO(solver);
    const Cell cell =
        ode_cell(fmt::format("dahlquist:rate=100,solver={}", solver), Precision::fp64);
    const ExactValues exact = compute_exact(
        test::device(), test::catalog().integrand(cell.scene.integrand, "test"), cell.scene);
    REQUIRE(exact.discrete_mean);
    const double bias = std::fabs(*exact.discrete_mean - *exact.mean);
    const auto measured =
        measure_integrator(test::catalog(), test::device(), test::device(), cell, 1 << 10);
    REQUIRE(measured);
    CHECK(*measured == Approx(bias).epsilon(within));
  }
  CHECK(!measure_integrator(test::catalog(), test::device(), test::device(),
                            ode_cell("exp-sum:d=1", Precision::fp64), 1 << 10));
}

TEST_CASE("the gap of precisions keeps grid, rounding and tolerance apart", "[device]") {
  // x is exact in fp32 at 23 bits, so nothing but the grid is left, and that of centred points is
  // of second order.
  const GapMeasurement exact = measure_gap(test::catalog(), test::device(), test::device(),
                                           ode_cell("sum-x:d=1", Precision::fp32), 1 << 10);
  REQUIRE(exact.reason.empty());
  CHECK(exact.evaluation.mean == 0);
  CHECK(exact.evaluation.sd == 0);
  CHECK(std::fabs(exact.coordinates.mean) < 0x1p-24);
  // In fp32 the solver raises its tolerance; that is the integrator's, not rounding.
  const Cell kaps = ode_cell("kaps:solver=rodas4,tolerance=1e-8", Precision::fp32);
  const GapMeasurement gap =
      measure_gap(test::catalog(), test::device(), test::device(), kaps, 1 << 8);
  REQUIRE(gap.reason.empty());
  const auto bias =
      measure_integrator(test::catalog(), test::device(), test::device(), kaps, 1 << 8);
  REQUIRE(bias);
  CHECK(*bias > 0);
  CHECK(*bias > gap.evaluation.rms_at(1 << 8));
}

TEST_CASE("a user's integrand is checked before its cases run", "[device]") {
  const test::TemporaryFolder folder;
  Json entry = Json::parse(test::repository_file("integrands/product/sum-x.json"));
  entry["name"] = "mine";
  entry.erase("stability");
  const std::string code = test::repository_file("integrands/product/sum-x.cl");
  const std::string path = folder.write("mine.json", entry.dump());
  folder.write("mine.cl", code);
  const std::string out = " --out " + folder.path("s.json");
  const auto good = test::run_command("stability --integrand " + path + out);
  INFO(good.output);
  CHECK(good.status == 0);
  CHECK(good.output.find("mine:d=") != std::string::npos);
  folder.write("mine.cl", code + "\nnonsense\n");
  const auto bad = test::run_command("stability --integrand " + path + out);
  INFO(bad.output);
  CHECK(bad.status == 2);
  CHECK(bad.output.find("mine.cl") != std::string::npos);
}
