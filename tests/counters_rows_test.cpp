// Counting changes no sum, and what rows say of it.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "device/integrator.hpp"
#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;

TEST_CASE("n_eff and kappa are numbers or nothing", "[unit]") {
  Counters k;
  CHECK_FALSE(k.n_eff());  // nothing was hit
  CHECK_FALSE(k.kappa(0));
  k.unit = 0x1p500;
  k.sum_abs = 6;
  k.sum_squares = 12;
  CHECK(k.n_eff() == 3.0);
  CHECK(k.kappa(-0x1p501) == 3.0);
  CHECK_FALSE(k.kappa(0));
  CHECK_FALSE(k.kappa(NAN));
  k.sum_squares = INFINITY;
  CHECK_FALSE(k.n_eff());
  k.sum_squares = 0;  // underflow
  CHECK_FALSE(k.n_eff());
  k.sum_squares = 12;
  k.minus_inf = 1;
  CHECK_FALSE(k.n_eff());
  CHECK_FALSE(k.kappa(1));
}

TEST_CASE("counting leaves every partial sum the same bits, and rows tell what was counted",
          "[device]") {
  struct Case {
    const char *scene, *sampler, *estimator;
    std::uint64_t zeros;  // points with a coordinate 0
  };
  for (const Case& one : {Case{"keister:d=3", "sobol", "", 1},
                          Case{"genz-gaussian:d=2", "sobol:randomize=rotate", "", 0},
                          Case{"simplex-indicator:d=2,t=0.9", "random", "mc", 0},
                          Case{"linear-prod:d=2", "random-antithetic", "", 0}}) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      constexpr std::uint64_t n = 1000;
      Cell c = cell(one.scene, one.sampler, n, 1, one.estimator);
      c.precision = precision;
      PlanOptions options;
      const auto run = [&](bool counters) {
        options.counters = counters;
        Plan plan = make_plan(test::catalog(), c, test::device().facts(), "", options);
        const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
        Integrator integrator(test::device(), plan, exact.coefficients);
        std::vector<std::uint64_t> bits;
        integrator.run(n, 0.25, [&](auto, auto, std::span<const double> partials) {
          for (const double p : partials) bits.push_back(std::bit_cast<std::uint64_t>(p));
        });
        return bits;
      };
      INFO(one.scene << " " << one.sampler << " " << precision_name(precision));
      REQUIRE(run(true) == run(false));

      PreparedCell prepared(test::catalog(), test::device(), test::device(),
                            make_plan(test::catalog(), c, test::device().facts(), "",
                                      (options.counters = true, options)));
      const Row row = prepared.run_row(n);
      REQUIRE(row.counters);
      CHECK(row.counters->samples == n);
      CHECK(row.counters->coord_le0 == one.zeros);
      CHECK(row.counters->coord_ge1 == 0);
      // Keister at 0 takes the cosine of infinity.
      CHECK(row.nonfinite == one.zeros);
      CHECK(row.counters->nan == one.zeros);
      CHECK(row.kappa.has_value() == (one.zeros == 0));
      if (one.zeros > 0) continue;
      // None of these f is negative: kappa is 1, and the mean that of |f|.
      CHECK(*row.kappa == Approx(1).epsilon(1e-6));
      CHECK(row.counters->sum_abs * row.counters->unit / n ==
            Approx(row.estimates.front()).epsilon(1e-6));
    }
  }
}

TEST_CASE("the limit of blow-ups is 1e30 E|f|, and beyond all numbers where that is not known",
          "[unit]") {
  ExactValues exact;
  CHECK(blow_up_limit(exact) == INFINITY);
  exact.mean_abs = 0;
  CHECK(blow_up_limit(exact) == INFINITY);
  exact.mean_abs = 2;
  CHECK(blow_up_limit(exact) == 2e30);
}
