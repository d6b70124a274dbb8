// Faults that a verdict names before any error is looked at, each once, and what leaves it alone.
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "estimate/stability.hpp"

namespace koksma {
namespace {

using Catch::Matchers::Contains;

// A cell without a fault.
CellFacts faultless() {
  CellFacts facts;
  facts.mean = 1;
  facts.mean_abs = 1;
  facts.n_eff = 1000;
  facts.errors = summarise_errors(std::vector<double>{0.9, 1.1, 0.95, 1.05}, 1.0);
  facts.rate.verdict = "within-gate";
  return facts;
}

}  // namespace

TEST_CASE("an integrator is unstable where a sample leaves the bound of the true solution",
          "[unit][estimate]") {
  const auto verdict_of = [](const CellFacts& facts) { return decide_verdict(facts, 1).verdict; };
  CellFacts facts = faultless();
  facts.ode = true;
  facts.bound = 2;
  facts.largest = 20;
  facts.blow_ups = 0;
  CHECK(verdict_of(facts) == "OK");
  // A mean above the limit tells of a sample above it, counted or not.
  facts.largest = 20.1;
  CHECK(verdict_of(facts) == "UNSTABLE_INTEGRATOR");
  facts.bound.reset();
  CHECK(verdict_of(facts) == "OK");
  facts.largest = 1.1e30;
  CHECK(verdict_of(facts) == "UNSTABLE_INTEGRATOR");
  facts.largest = 1;
  facts.blow_ups = 1;
  CHECK(verdict_of(facts) == "UNSTABLE_INTEGRATOR");
  // The same of another f is a matter of f.
  facts.ode = false;
  CHECK(verdict_of(facts) == "OK");
}

TEST_CASE("what is no number, out of range or not used once is a fault of the domain",
          "[unit][estimate]") {
  const auto fault = [](const std::function<void(CellFacts&)>& change, const std::string& why) {
    CellFacts facts = faultless();
    facts.n_eff = 1;
    change(facts);
    const CellVerdict verdict = decide_verdict(facts, 1);
    INFO(why);
    CHECK(verdict.verdict == "DOMAIN_FAULT");
    CHECK_THAT(verdict.reason, Contains(why));
  };
  fault([](CellFacts& f) { f.nonfinite = 1; }, "samples of all rows are not finite");
  fault([](CellFacts& f) { f.nonfinite_replicates = 1; }, "sums of 1 replicates");
  fault([](CellFacts& f) { f.out_of_range = 1; }, "outside the range");
  fault([](CellFacts& f) { f.index_fault = true; }, "not used exactly once");
  CellFacts counted = faultless();
  counted.out_of_range = 0;
  CHECK(decide_verdict(counted, 1).verdict == "OK");
}

TEST_CASE("samples that were counted decide where the exact moments do not", "[unit][estimate]") {
  CellFacts facts = faultless();
  facts.empirical_n_eff = 29;
  CHECK(decide_verdict(facts, 1).verdict == "UNRESOLVED");
  CHECK_THAT(decide_verdict(facts, 1).reason, Contains("of the samples"));
  facts.empirical_n_eff = 30;
  CHECK(decide_verdict(facts, 1).verdict == "OK");
  facts.hits = 0;
  CHECK(decide_verdict(facts, 1).verdict == "UNRESOLVED");
  // f = 0 is hit nowhere.
  facts.mean_abs = 0;
  CHECK(decide_verdict(facts, 1).verdict == "OK");
}

TEST_CASE("OVERFLOW stands beside any verdict", "[unit][estimate]") {
  CellFacts facts = faultless();
  CHECK(decide_verdict(facts, 1).marks.empty());
  facts.overflows = true;
  for (const bool fault : {false, true}) {
    facts.index_fault = fault;
    const CellVerdict verdict = decide_verdict(facts, 1);
    CHECK(verdict.verdict == (fault ? "DOMAIN_FAULT" : "OK"));
    REQUIRE(verdict.marks.size() == 1);
    CHECK(verdict.marks[0] == "OVERFLOW");
  }
}

TEST_CASE("an error above E|f|/2 is unresolved where n_eff is not known, and not at the floor",
          "[unit][estimate]") {
  ResolutionFacts facts;
  facts.error = 0.51;
  facts.mean_abs = 1;
  CHECK(why_unresolved(facts) == "RMSE > E|f|/2");
  facts.floor = 0.18;
  CHECK(why_unresolved(facts).empty());
  facts.floor = 0;
  // A lattice that aliases has enough samples, and the wrong ones.
  facts.n_eff = 30;
  CHECK(why_unresolved(facts).empty());
  facts.n_eff = 29.9;
  CHECK(why_unresolved(facts) == "n_eff below 30");
  facts.infinite_variance = true;
  CHECK(why_unresolved(facts).empty());
  facts.hit_nothing = true;
  CHECK(why_unresolved(facts) == "every sample of f is 0");
}

}  // namespace koksma
