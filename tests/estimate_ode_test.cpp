// What cells whose f solves a differential equation report: growth of the scheme, two errors, bias.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "estimate/assess.hpp"
#include "estimate/ode.hpp"
#include "tests/support.hpp"

namespace koksma {
namespace {

// z = -100 … 0 at 100 steps, as page 5 has the test equation of Dahlquist.
constexpr double kOdeIntegral = 1e-4;

// A cell of which everything is made up but the plan.
struct MadeOde {
  Plan plan = make_plan(test::catalog(), test::cell("linear-prod:d=1", "sobol-owen", 256, 32), {});
  Integrand integrand = *plan.integrand;
  ExactValues exact;
  Kurtosis kurtosis;
  CellResult result;

  MadeOde() {
    integrand.ode_size = 1;
    plan.integrand = &integrand;
    plan.cell.replicates = 32;
    exact.mean = exact.mean_abs = kOdeIntegral;
    exact.variance = 4e-5;
  }
  MadeOde(const MadeOde&) = delete;
  MadeOde& operator=(const MadeOde&) = delete;

  // Rows of N = 2^12 … 2^20 about `centre`, converging like N^-1.
  void run(double centre, double size) {
    std::mt19937_64 engine(91);
    std::normal_distribution<double> normal;
    for (unsigned m = 12; m <= 20; ++m) {
      Row row;
      row.n = std::uint64_t{1} << m;
      std::vector<double> estimates;
      for (int r = 0; r < 32; ++r)
        estimates.push_back(centre + size * std::exp2(12.0 - m) * normal(engine));
      assess_row({plan, exact, kurtosis}, estimates, {}, row);
      result.rows.push_back(row);
    }
    assess_cell({plan, exact, kurtosis}, std::nullopt, 0, result);
  }
};

}  // namespace

TEST_CASE("max |R(z)| over the stiffness: damping, growth, and a pole that is none",
          "[unit][estimate]") {
  const std::vector<double> one = {1}, euler = {1, 1}, backward = {1, -1}, half = {1, 0.5},
                            other_half = {1, -0.5};
  CHECK(*largest_growth(euler, one, 100) == Approx(99));
  CHECK(*largest_growth(euler, one, 1.5) == Approx(1));  // at z = 0
  CHECK(*largest_growth(one, backward, 1e6) == Approx(1));
  CHECK(*largest_growth(half, other_half, 1e6) == Approx(1));
  const std::vector<double> rk4 = {1, 1, 0.5, 1.0 / 6, 1.0 / 24};
  CHECK(*largest_growth(rk4, one, 100) == Approx(4004901).epsilon(1e-3));
  CHECK_FALSE(largest_growth(one, euler, 1));  // the pole at -1
  CHECK_FALSE(largest_growth({}, one, 1));
  CHECK_FALSE(largest_growth(one, one, 0));
}

TEST_CASE("growth between the ends is found, also at steps that are small beside the stiffness",
          "[unit][estimate]") {
  // |1 + 12 z/s + 12 (z/s)^2| is 2 in the middle.
  const std::vector<double> one = {1};
  for (const double s : {1.0, 1e5}) {
    const std::vector<double> bump = {1, 12 / s, 12 / (s * s)};
    CHECK(*largest_growth(bump, one, s) == Approx(2).epsilon(1e-5));
  }
  // (1 - 4 z)/(1 + z^2) is largest at z = (1 - sqrt 17)/4, and 1e-5 at the other end.
  const std::vector<double> rising = {1, -4}, falling = {1, 0, 1};
  CHECK(*largest_growth(rising, falling, 1e6) == Approx(2.5616).epsilon(1e-3));
}

TEST_CASE(
    "sampling error and bias are told apart by the mean of the numerical solution, or by the "
    "replicates",
    "[unit][estimate]") {
  const std::vector<double> estimates = {3, 3.5, 4, 3.5};
  const OdeReport known = report_ode(estimates, 1.0, 3.5);
  CHECK(*known.sampling_rmse == Approx(std::sqrt(0.125)));
  CHECK(known.sampling_against == "discrete mean");
  CHECK(*known.total_rmse == Approx(std::sqrt(6.25 + 0.125)));
  CHECK(known.integrator_bias == 2.5);
  CHECK_FALSE(known.bias_error);
  const OdeReport seen = report_ode(estimates, 1.0, std::nullopt);
  CHECK(*seen.sampling_rmse == Approx(std::sqrt(0.5 / 3)));
  CHECK(seen.sampling_against == "replicates");
  CHECK(*seen.integrator_bias == Approx(2.5));
  CHECK(*seen.bias_error == Approx(std::sqrt(0.5 / 3) / 2));
  const std::vector<double> broken = {3, NAN};
  const OdeReport none = report_ode(broken, 1.0, 3.5);
  CHECK_FALSE(none.sampling_rmse);
  CHECK_FALSE(none.total_rmse);
  CHECK(none.integrator_bias == 2.5);
}

TEST_CASE("a scheme that is far off but stable ends at a numeric plateau of its integrator",
          "[unit][estimate]") {
  MadeOde trapezoid;
  trapezoid.exact.discrete_mean = trapezoid.exact.discrete_mean_abs = 33 * kOdeIntegral;
  trapezoid.exact.discrete_variance = 1e-4;
  trapezoid.exact.bound = 1;
  trapezoid.run(33 * kOdeIntegral, 1e-4);
  const CellResult& result = trapezoid.result;
  INFO(result.stability.reason);
  CHECK(result.stability.verdict == "PLATEAU_NUMERIC");
  CHECK_THAT(result.stability.reason, Catch::Contains("integrator"));
  CHECK(result.floors.dominant() == "integrator");
  CHECK(result.rate.used.empty());
  CHECK(*result.ode->integrator_bias == Approx(32 * kOdeIntegral));
  CHECK(*result.ode->sampling_rmse < 1e-5);
  CHECK(*result.ode->total_rmse == Approx(32 * kOdeIntegral).epsilon(0.01));
}

TEST_CASE("a small bias of the integrator is reported and no fault", "[unit][estimate]") {
  MadeOde backward;
  backward.exact.discrete_mean = backward.exact.discrete_mean_abs = 1.01 * kOdeIntegral;
  backward.exact.discrete_variance = 4e-5;
  // At 2^20 the sampling error is a tenth of the bias: the curve is not flat yet.
  backward.run(1.01 * kOdeIntegral, 256e-7);
  const CellResult& result = backward.result;
  INFO(result.stability.reason);
  CHECK(result.stability.verdict == "OK");
  CHECK_THAT(result.stability.reason, Catch::Contains("the bias is that of the floor, integrator"));
  CHECK(*result.ode->integrator_bias == Approx(0.01 * kOdeIntegral));
}

TEST_CASE("a bias that is the same at half of N is the integrator's where its mean is not known",
          "[unit][estimate]") {
  MadeOde unknown;
  unknown.run(1.02 * kOdeIntegral, 64e-7);
  INFO(unknown.result.stability.reason);
  CHECK(unknown.result.floors.dominant() == "integrator");
  CHECK(*unknown.result.floors.integrator.estimate == Approx(0.02 * kOdeIntegral).epsilon(0.1));
  CHECK((unknown.result.stability.verdict == "OK" ||
         unknown.result.stability.verdict == "PLATEAU_NUMERIC"));
  // The same estimates of an f that solves nothing are biased.
  MadeOde plain;
  plain.integrand.ode_size = 0;
  plain.run(1.02 * kOdeIntegral, 64e-7);
  CHECK((plain.result.stability.verdict == "BIASED" ||
         plain.result.stability.verdict == "PLATEAU_STRUCTURAL"));
  CHECK_FALSE(plain.result.ode);
}

TEST_CASE("moments of the numerical solution decide what is resolved", "[unit][estimate]") {
  MadeOde rare;
  rare.exact.discrete_mean = rare.exact.discrete_mean_abs = kOdeIntegral;
  rare.exact.discrete_variance = 1;  // n_eff = 2^20 1e-8
  rare.run(kOdeIntegral, 1e-6);
  CHECK(rare.result.stability.verdict == "UNRESOLVED");
  CHECK(*rare.result.stability.n_eff == Approx(0x1p20 * 1e-8).epsilon(1e-6));
  MadeOde overflowing;
  overflowing.exact.discrete_overflows = true;
  overflowing.run(kOdeIntegral, 1e-6);
  CHECK(overflowing.result.stability.verdict == "UNRESOLVED");
  REQUIRE(overflowing.result.stability.marks.size() == 1);
  CHECK(overflowing.result.stability.marks[0] == "OVERFLOW");
}

}  // namespace koksma
