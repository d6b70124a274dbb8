// Floors: the formulas of the four terms, what is measured in their place, and how near the
// estimates are to the floors that curves end at.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "estimate/exact_sum.hpp"
#include "estimate/measure.hpp"
#include "estimate/statistics.hpp"
#include "tests/support.hpp"

namespace koksma {
namespace {

FloorFacts smooth() {
  FloorFacts facts;
  facts.mean = 1;
  facts.mean_abs = 2;
  facts.sd = 0.5;
  facts.summation = 1e-20;
  facts.summation_bound = 1e-17;
  return facts;
}

// Means of the replicates at these options.
std::vector<double> means(const Cell& cell, Precision precision, const PlanOptions& options) {
  Cell c = cell;
  c.precision = precision;
  Plan plan = make_plan(test::catalog(), c, test::device().facts(), "", options);
  const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
  plan.request.dimension_order = exact.dimension_order;
  Integrator integrator(test::device(), plan, exact.coefficients);
  std::vector<ExactSum> sums(plan.launched_replicates());
  integrator.run(c.n.back(), 0.0, [&](std::uint32_t word, std::uint32_t r, auto partials) {
    sums[r].add(partials, plan.word_exponent(word));
  });
  std::vector<double> result;
  for (const ExactSum& sum : sums) result.push_back(sum.rounded_quotient(c.n.back()));
  return result;
}

double rms_gap(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> gap;
  for (std::size_t r = 0; r < a.size(); ++r) gap.push_back(a[r] - b[r]);
  return root_mean_square(gap);
}

}  // namespace

TEST_CASE("the integrator's floor is the distance of its mean to the integral",
          "[unit][estimate]") {
  FloorFacts facts = smooth();
  CHECK(predict_floors(facts).integrator.estimate == 0.0);
  facts.ode = true;
  CHECK_FALSE(predict_floors(facts).integrator.estimate);
  CHECK_FALSE(predict_floors(facts).integrator.reason.empty());
  facts.mean_error = -3e-3;
  CHECK(predict_floors(facts).integrator.estimate == 3e-3);
  CHECK_FALSE(predict_floors(facts).integrator.bound);
  facts.discrete_mean = 0.75;
  CHECK(predict_floors(facts).integrator.estimate == 0.25);
  CHECK(predict_floors(facts).integrator.bound == 0.25);
  CHECK(predict_floors(facts).predicted_total() == 0.25);
  CHECK(predict_floors(facts).dominant() == "integrator");
}

TEST_CASE("the grid's floor is 2^-(b+1) sqrt(12 d) sigma where coordinates are rounded down",
          "[unit][estimate]") {
  FloorFacts facts = smooth();
  facts.coordinate_bits = 23;
  facts.dim = 3;
  CHECK(predict_floors(facts).coordinate.estimate == 0.0);
  facts.truncated = true;
  CHECK(*predict_floors(facts).coordinate.estimate == Approx(0x1p-24 * 3));
  CHECK_FALSE(predict_floors(facts).coordinate.bound);
  facts.variation = 2.5;
  CHECK(*predict_floors(facts).coordinate.estimate == Approx(0x1p-24 * 2.5));
  CHECK(*predict_floors(facts).coordinate.bound == Approx(0x1p-23 * 2.5));
  facts.variation = 10;
  CHECK(*predict_floors(facts).coordinate.estimate == Approx(0x1p-24 * 3));
  facts.periodic = true;
  CHECK(predict_floors(facts).coordinate.estimate == 0.0);
}

TEST_CASE("the integrand's floor is 0.2 u E|f|, at most ulps u E|f|", "[unit][estimate]") {
  FloorFacts facts = smooth();
  facts.unit_roundoff = 0x1p-24;
  facts.ulps = 16;
  CHECK(*predict_floors(facts).integrand.estimate == Approx(0.2 * 2 * 0x1p-24));
  CHECK(*predict_floors(facts).integrand.bound == 16 * 2 * 0x1p-24);
  facts.mean_abs.reset();
  CHECK(*predict_floors(facts).integrand.estimate == Approx(0.2 * std::sqrt(1.25) * 0x1p-24));
  facts.sd.reset();
  CHECK(*predict_floors(facts).integrand.estimate == Approx(0.2 * 0x1p-24));
  facts.mean.reset();
  CHECK_FALSE(predict_floors(facts).integrand.estimate);
  CHECK(predict_floors(facts).predicted_total() == facts.summation);
  CHECK(predict_floors(facts).dominant() == "summation");
}

TEST_CASE("what was measured takes the place of a formula, and the largest term rules",
          "[unit][estimate]") {
  const FloorFacts facts = smooth();
  MeasuredFloors measured;
  for (const char* name : {"integrator", "coordinate", "integrand", "summation"}) {
    std::optional<double>& term = std::string(name) == "integrator"   ? measured.integrator
                                  : std::string(name) == "coordinate" ? measured.coordinate
                                  : std::string(name) == "integrand"  ? measured.integrand
                                                                      : measured.summation;
    term = 1e-3;
    CHECK(predict_floors(facts, measured).dominant() == name);
    CHECK(predict_floors(facts, measured).predicted_total() == 1e-3);
    term = 0.0;
  }
  CHECK(predict_floors(facts, measured).predicted_total() == 0);
  CHECK(predict_floors(facts, measured).dominant().empty());
  // The bounds stay.
  CHECK(*predict_floors(facts, measured).summation.bound == 1e-17);
  FloorFacts against = facts;
  against.reference = 1e-4;
  CHECK(predict_floors(against, measured).dominant() == "reference");
}

TEST_CASE("roundings of a sum average out over its accumulators, unless all terms are equal",
          "[unit][estimate]") {
  Plan plan = make_plan(test::catalog(), test::cell("linear-prod:d=1", "random", 1 << 20), {});
  plan.sum = &test::catalog().sum("naive", "test");
  plan.precision = Precision::fp32;
  ExactValues exact;
  exact.mean = exact.mean_abs = 1;
  exact.variance = 1;
  const Kurtosis kurtosis;
  const CellContext context{plan, exact, kurtosis};
  // 2^20 samples are 64 blocks of 16 accumulators of 2^10 terms: 2^5 u each, 2^5 of them to
  // average.
  const Floor varying = formula_floors(context, 1 << 20).summation;
  CHECK(*varying.estimate == Approx(0x1p-24).epsilon(1e-6));
  CHECK(*varying.bound == Approx(0x1p10 * 0x1p-24).epsilon(1e-2));
  // 0.1f in fp32, 2^20 terms in one accumulator: seen 9.9e-3, the bound is 6.2e-2 (page 5, appendix
  // C).
  exact.variance = 0;
  const Floor equal = formula_floors(context, 1 << 20).summation;
  CHECK(*equal.estimate == Approx(0x1p10 * 0x1p-24 / 6).epsilon(1e-2));
  // The result is rounded to double, whatever the sum.
  plan.sum = &test::catalog().sum("double", "test");
  exact.variance = 1;
  CHECK(*formula_floors(context, 16).summation.estimate >= 0.4 * 0x1p-53);
}

TEST_CASE("rounding in fp32 moves means by about 0.2 u E|f|: the factor is measured", "[device]") {
  // From 0.04 (exp-sum is 0.54, annuity-ar1 0.15) to 1.4 (poisson-kernel at d = 2); see floors.hpp.
  for (const char* scene : {"exp-sum:d=1", "annuity-ar1:d=1", "genz-gaussian:d=1", "x-exp-x:d=1",
                            "poisson-kernel:d=2"}) {
    Cell cell = test::cell(scene, "sobol-owen", 1 << 13, 16);
    cell.sum = "double";
    PlanOptions coarse;
    coarse.coarse_coordinates = true;
    const ExactValues exact = compute_exact(
        test::device(), test::catalog().integrand(cell.scene.integrand, "test"), cell.scene);
    const double gap =
        rms_gap(means(cell, Precision::fp32, {}), means(cell, Precision::fp64, coarse));
    const double estimate = kRoundingFactor * 0x1p-24 * *exact.mean_abs;
    INFO(scene << ": " << gap / estimate << " of the estimate");
    CHECK(gap > estimate / 10);
    CHECK(gap < estimate * 10);
  }
}

TEST_CASE("coordinates that are rounded down move means by the grid's floor", "[device]") {
  for (const char* sampler : {"halton-folded", "kronecker"}) {
    for (const char* scene : {"exp-sum:d=1", "exp-sum:d=5"}) {
      Cell cell = test::cell(scene, sampler, 1 << 14);
      cell.precision = Precision::fp32;
      const Plan plan = make_plan(test::catalog(), cell, test::device().facts());
      const ExactValues exact = compute_exact(test::device(), *plan.integrand, cell.scene);
      const Kurtosis kurtosis;
      const Floor floor = formula_floors({plan, exact, kurtosis}, 1 << 14).coordinate;
      PlanOptions coarse;
      coarse.coarse_coordinates = true;
      const double gap =
          rms_gap(means(cell, Precision::fp64, coarse), means(cell, Precision::fp64, {}));
      INFO(scene << " " << sampler << ": " << gap / *floor.estimate << " of the estimate");
      CHECK(gap > *floor.estimate / 3);
      CHECK(gap < *floor.estimate * 3);
      if (floor.bound) CHECK(gap < *floor.bound * 1.01);
    }
  }
}

TEST_CASE("curves end within a factor of 10 of their estimated floors", "[device]") {
  struct Curve {
    const char *scene, *sampler;
    Precision precision;
  };
  for (const Curve& curve : {Curve{"genz-gaussian:d=1", "lattice-shift-tent", Precision::fp32},
                             Curve{"halfpi-sin:d=1", "lattice-shift", Precision::fp32},
                             Curve{"annuity-ar1:d=1", "lattice-shift-tent", Precision::fp32},
                             Curve{"expcos:d=2", "lattice-shift", Precision::fp32},
                             Curve{"korobov-b4:d=1", "lattice-shift", Precision::fp64}}) {
    const CellResult result =
        test::run_sizes(curve.scene, curve.sampler, "2^9..2^18", 16, curve.precision);
    INFO(curve.scene << ": " << result.rate.plateau.level << " at an estimated " << result.floor
                     << ", " << result.stability.reason);
    CHECK(result.stability.verdict == "PLATEAU_NUMERIC");
    CHECK(result.rate.plateau.level < 10 * result.floor);
    CHECK(result.rate.plateau.level > result.floor / 10);
  }
}

}  // namespace koksma
