// What a row reports: estimates, standard errors, counts of faults, times, block lengths, floors.
#include "estimate/measure.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <map>

#include "catalog/embedded.hpp"
#include "estimate/exact_sum.hpp"
#include "estimate/timed_launches.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;

TEST_CASE("all 64 bits of the seed reach the samples", "[device]") {
  const std::uint64_t seed = (1ULL << 40) + 5;
  for (const char* sampler : {"random", "sobol-owen", "lattice-shift"}) {
    Cell c = cell(test::kIdentity, sampler, 16);
    c.seed = seed;
    const Plan plan = make_plan(test::catalog(), c, test::device().facts());
    const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
    const auto y = Integrator(test::device(), plan, exact.coefficients).first_values();
    const auto x = test::points({.sampler = sampler, .dim = 1, .count = 16, .seed = seed});
    INFO(sampler);
    for (std::size_t i = 0; i < 16; ++i) REQUIRE(y[i] == x[i] + 0.5);
    CHECK(x != test::points({.sampler = sampler, .dim = 1, .count = 16, .seed = 5}));
  }
}

TEST_CASE("the block length follows from N alone and is what a row was summed with", "[device]") {
  const std::map<std::uint64_t, std::uint32_t> expected = {
      {1, 8},           {1ULL << 14, 8},        {(1ULL << 14) + 1, 9}, {1ULL << 18, 12},
      {1ULL << 22, 16}, {(1ULL << 22) + 1, 16}, {1ULL << 40, 16}};
  for (const auto& [n, length] : expected) CHECK(log2_block_length(n) == length);
  const Plan plan =
      make_plan(test::catalog(), cell(test::kIdentity, "sobol", 1 << 15), test::device().facts());
  PreparedCell prepared(test::catalog(), test::device(), test::device(), plan);
  CHECK(prepared.run_row(1 << 15).log2_block == 9);
  std::size_t partials = 0;
  prepared.integrator().run(
      1 << 15, 0.0, [&](std::uint32_t, std::uint32_t, auto part) { partials += part.size(); });
  CHECK(partials == 1024);
}

TEST_CASE("an estimate is the correctly rounded sum of its partial sums, for every launch split",
          "[device]") {
  for (const SumAlgorithm& sum : test::catalog().sums) {
    Cell c = cell("genz-oscillatory:d=3", "random", 1 << 14, 3);
    c.sum = sum.name;
    const auto partials = test::partial_sums(c, {16, 1, {}, {}});
    std::vector<double> expected;
    const std::size_t size = 1024;  // of one word of one replicate
    for (std::size_t r = 0; r < 3; ++r) {
      ExactSum total;
      for (unsigned word = 0; word < sum.words(true); ++word)
        total.add(std::span(partials).subspan((std::size_t{word} * 3 + r) * size, size),
                  sum.word_exponent(true, word));
      expected.push_back(total.rounded_quotient(1 << 14));
    }
    for (const std::optional<std::uint64_t> items : {std::optional<std::uint64_t>(), {7}}) {
      PreparedCell prepared(test::catalog(), test::device(), test::device(),
                            make_plan(test::catalog(), c, test::device().facts(), "",
                                      {LaunchShape{16, 1, {}, items}}));
      INFO(sum.name);
      CHECK(prepared.run_row(1 << 14).estimates == expected);
    }
  }
}

TEST_CASE("the standard error of random is sigma / sqrt(N R), whatever the mean, sum and precision",
          "[statistical]") {
  // Mean 1, sigma 0.029; 2^16 values tell sigma to 0.2 % (kurtosis 1.8): the limit is 5 standard
  // deviations.
  for (const SumAlgorithm& sum : test::catalog().sums) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      Cell c = cell("linear-prod:d=1,scale=0.1,power=0", "random", 1 << 14, 4);
      c.precision = precision;
      c.sum = sum.name;
      PreparedCell prepared(test::catalog(), test::device(), test::device(),
                            make_plan(test::catalog(), c, test::device().facts()));
      const Row row = prepared.run_row(1 << 14);
      const double expected = std::sqrt(*prepared.exact().variance / (4 << 14));
      INFO(sum.name << " " << precision_name(precision));
      REQUIRE(row.estimate.standard_error);
      CHECK(*row.estimate.standard_error == Approx(expected).epsilon(0.01));
    }
  }
}

TEST_CASE("non-finite samples are counted wherever they are: first or last, any replicate, any N",
          "[device]") {
  // f = infinity where x < 1/4.
  const test::TemporaryFolder folder;
  const Integrand& model = test::catalog().integrand("linear-prod", "test");
  Json entry = parse_json(
      embedded_text(model.code.path.substr(0, model.code.path.size() - 3) + ".json"), "test");
  entry["name"] = "my-holes";
  std::string code = model.code.text;
  const std::string from = "return product;";
  REQUIRE(code.find(from) != std::string::npos);
  code.replace(code.find(from), from.size(),
               "return select_real(product < R(0.75), product / (product - product), product);");
  folder.write("my-holes.cl", code);
  const Catalog catalog = load_catalog({folder.write("my-holes.json", entry.dump())});
  for (const std::uint64_t n : {1ULL, 3ULL, 16ULL, 37ULL, 256ULL, 300ULL, 1000ULL}) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      for (const std::uint32_t lanes : {1U, 16U}) {
        Cell c = cell(test::kIdentity, "random", n, 5);
        c.scene.integrand = "my-holes";
        c.precision = precision;
        PreparedCell prepared(
            catalog, test::device(), test::device(),
            make_plan(catalog, c, test::device().facts(), "", {LaunchShape{lanes, 1, {}, 7}}));
        std::uint64_t expected = 0;
        for (std::uint32_t r = 0; r < 5; ++r)
          for (const double x : test::points({.sampler = "random",
                                .dim = 1,
                                .precision = precision,
                                .count = n,
                                .replicate = r}))
            expected += x < 0.25 ? 1 : 0;
        INFO("N = " << n << " " << precision_name(precision) << " lanes " << lanes);
        CHECK(prepared.run_row(n).nonfinite == expected);
      }
    }
  }
}

TEST_CASE("a short row is repeated 5 times, and fewer times only after 20 ms", "[device][timing]") {
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell("linear-prod:d=2", "sobol-owen", 256, 2),
                                  test::device().facts()));
  const auto start = std::chrono::steady_clock::now();
  const Row row = prepared.run_row(256);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  CHECK(row.kernel.count <= 5);
  CHECK((row.kernel.count == 5 || spent.count() >= 0.020));
  CHECK(row.wall.count == row.kernel.count);
  // The median is not the minimum: in ten rows, some times differ.
  bool apart = false;
  for (int i = 0; i < 10; ++i) {
    const Row again = prepared.run_row(256);
    apart = apart || (again.kernel.median > again.kernel.min && again.wall.median > again.wall.min);
  }
  CHECK(apart);
}

TEST_CASE("the time of a run is that of all its launches", "[device][timing]") {
  const Cell c = cell("genz-gaussian:d=20", "random", 1 << 16, 1);
  const auto fastest = [&](std::optional<std::uint64_t> items) {
    const Plan plan =
        make_plan(test::catalog(), c, test::device().facts(), "", {LaunchShape{16, 1, {}, items}});
    const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
    Integrator integrator(test::device(), plan, exact.coefficients);
    double least = INFINITY;
    for (int i = 0; i < 5; ++i)
      least = std::min(least, integrator.run(1 << 16, 0.0, [](auto, auto, auto) {}));
    return least;
  };
  // 64 launches of one block: as much work, less of it at once.
  CHECK(fastest(1) > fastest({}) / 2);
}

TEST_CASE("runs made together have times of their own, in order, and change no sums",
          "[device][timing]") {
  const Plan plan =
      make_plan(test::catalog(), test::cell("linear-prod:d=8", "sobol-lms-shift", 1 << 16, 8),
                test::device().facts());
  Integrator integrator(
      test::device(), plan,
      compute_exact(test::device(), *plan.integrand, plan.cell.scene).coefficients);
  const auto sums = [&](std::uint64_t n) {
    std::vector<double> all;
    integrator.run(n, 0, [&](std::uint32_t, std::uint32_t, std::span<const double> partials) {
      all.insert(all.end(), partials.begin(), partials.end());
    });
    return all;
  };
  const auto before = sums(1 << 8);
  const std::vector<RepeatedRun> launches{{1 << 16, 1}, {1 << 8, 3}, {1 << 16, 1}, {1 << 8, 3}};
  REQUIRE(integrator.runs_at_once(1 << 16) >= 1);
  REQUIRE(integrator.runs_at_once(1 << 8) >= 3);
  // 256 times the work takes longer, whatever else runs: the least of three.
  std::vector<double> least(launches.size(), INFINITY);
  for (int k = 0; k < 3; ++k) {
    const auto times = integrator.times_together(launches, 0);
    REQUIRE(times.size() == launches.size());
    for (std::size_t i = 0; i < launches.size(); ++i) least[i] = std::min(least[i], times[i]);
  }
  CHECK(least[1] > 0);
  CHECK(std::min(least[0], least[2]) > 3 * std::max(least[1], least[3]));
  CHECK(sums(1 << 8) == before);
  // The blocks of this N are more than a launch takes.
  CHECK(integrator.runs_at_once(std::uint64_t{1} << 50) == 0);
}

TEST_CASE("short rows are run as often by a launch as it takes for its start not to show",
          "[device][timing]") {
  const std::uint64_t n = 1 << 8;
  const auto with_integrator = [&](std::uint32_t replicates, const auto& body) {
    const Plan plan =
        make_plan(test::catalog(), test::cell("linear-prod:d=8", "sobol-lms-shift", n, replicates),
                  test::device().facts());
    Integrator integrator(
        test::device(), plan,
        compute_exact(test::device(), *plan.integrand, plan.cell.scene).coefficients);
    body(integrator);
  };
  // The fastest of five launches of so many runs, per run.
  const auto fastest = [&](Integrator& integrator, std::uint32_t runs) {
    const std::vector<RepeatedRun> launches(5, {n, runs});
    const auto times = integrator.times_together(launches, 0);
    return *std::min_element(times.begin(), times.end());
  };
  const std::uint32_t busy = std::max(32U, 8 * test::device().facts().compute_units);
  with_integrator(busy, [&](Integrator& integrator) {
    const std::uint32_t room = integrator.runs_at_once(n);
    REQUIRE(room > 2048 / busy);
    REQUIRE(integrator.fills_device(n));
    // All of them first: their sums need room that no launch before has made.
    const double many = fastest(integrator, room), one = fastest(integrator, 1);
    CHECK(many < one);
    CHECK(many * room > one);
    const std::uint32_t runs = runs_of_launch(integrator, n, 0, one);
    CHECK(runs > 1);
    CHECK((runs == room || runs * fastest(integrator, runs) > kSecondsOfRuns / 2));
    CHECK(runs_of_launch(integrator, n, 0, kSecondsOfRuns) == 1);
  });
  // Of one block, side by side on all compute units.
  with_integrator(1, [&](Integrator& integrator) {
    REQUIRE(integrator.runs_at_once(n) > 64);
    CHECK_FALSE(integrator.fills_device(n));
    CHECK(runs_of_launch(integrator, n, 0, 1e-6) == 1);
  });
}

TEST_CASE("the chi-squared test is for independent, resolved samples only", "[device]") {
  const auto test_of = [](const char* sampler, std::uint64_t n) {
    PreparedCell prepared(
        test::catalog(), test::device(), test::device(),
        make_plan(test::catalog(), cell(test::kIdentity, sampler, n, 4), test::device().facts()));
    return prepared.run_row(n).mc_test;
  };
  CHECK(test_of("random", 64).applicable);
  // N (E|f|)^2 / E f^2 = 12/13 N.
  CHECK(test_of("random", 33).applicable);
  CHECK(test_of("random", 32).reason == "unresolved: n_eff below 30");
  for (const char* sampler : {"sobol", "sobol-owen", "sobol-lms-shift", "lattice-shift"}) {
    INFO(sampler);
    CHECK(test_of(sampler, 64).reason == "the samples are not independent");
  }
}

TEST_CASE("rows below three rounding floors do not enter the rate", "[device]") {
  // 1 + (x - 1/2) / 8 on the first 2^m points: the error is 2^-(m+4), the floor in fp32 about
  // 2^-26.3.
  Cell c = cell("linear-prod:d=1,scale=0.125,power=0", "sobol", 256);
  c.n = parse_sizes("2^15..2^21", "test");
  c.precision = Precision::fp32;
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), c, test::device().facts()));
  const CellResult result = prepared.run();
  CHECK(result.floor == formula_floors(prepared.context(), 1 << 21).predicted_total());
  CHECK(result.floor == Approx(kRoundingFactor * 0x1p-24));
  CHECK(result.floors.dominant() == "integrand");
  CHECK(result.rate.used.size() == 6);
  REQUIRE(result.rate.excluded.size() == 1);
  CHECK(result.rate.excluded[0].samples == 1 << 21);
  CHECK(result.rate.excluded[0].reason == "below the floor: RMSE < 3 F");
  CHECK(*result.rate.slope == Approx(-1).epsilon(0.01));
  // Errors are about the exact value.
  CHECK(*result.rows[0].errors.bias == Approx(-0x1p-19).epsilon(1e-3));
  CHECK(*result.rows[0].errors.rmse == Approx(0x1p-19).epsilon(1e-3));
}
