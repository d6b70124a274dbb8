// Moments of the integrands, what results say of times and sums by default.
#include <catch2/catch.hpp>
#include <cmath>

#include "estimate/measure.hpp"
#include "journal/cell_json.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;

TEST_CASE("sampled variances and mean absolute values meet the exact ones", "[statistical]") {
  // 2^16 independent values: 8 standard errors, estimated from the same values.
  std::vector<std::string> scenes;
  for (const Integrand& f : test::catalog().integrands) scenes.push_back(f.name);
  scenes.insert(scenes.end(),
                {"sobol-g:d=3,scale=0,offset=-0.5", "linear-prod:d=3,scale=-2,power=0"});
  for (const std::string& scene : scenes) {
    const Cell c = cell(scene, "random", 1 << 16);
    const Plan plan = make_plan(test::catalog(), c, test::device().facts());
    const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
    Integrator integrator(test::device(), plan, exact.coefficients);
    // Blocks of 16 samples store every value as its own partial sum; the last word is the square.
    std::vector<double> values;
    integrator.run_blocks(1 << 16, 4, 0, 1 << 12, 1, 0.0,
                          [&](std::uint32_t word, std::uint32_t, std::span<const double> p) {
                            if (word == 0) values.insert(values.end(), p.begin(), p.end());
                          });
    REQUIRE(values.size() == 1 << 16);
    // A solver leaves an error of its own, which scenes without variance show.
    const double own = plan.integrand->ode_size > 0 ? 1e-8 : 0;
    const auto meets = [&](auto quantity, double expected) {
      double mean = 0, square = 0;
      for (const double y : values) mean += quantity(y) / 65536;
      for (const double y : values) square += std::pow(quantity(y) - mean, 2) / 65536;
      INFO(scene << ": sampled " << mean << ", exact " << expected);
      CHECK(std::fabs(mean - expected) <=
            8 * std::sqrt(square / 65536) + 1e-14 * std::fabs(expected) + own);
    };
    if (exact.mean_abs) meets([](double y) { return std::fabs(y); }, *exact.mean_abs);
    if (exact.mean && exact.variance)
      meets([&](double y) { return std::pow(y - *exact.mean, 2); }, *exact.variance);
  }
}

TEST_CASE("times in the results are those of one replicate, throughput that of all", "[unit]") {
  CellResult result;
  result.cell = cell("linear-prod:d=3", "random", 256, 8);
  result.cell.n = {256, 512};
  result.exact.mean = 2;
  result.exact.variance = 1;
  result.verdict.verdict = "no-rate";
  for (const double size : {1.0, 2.0}) {
    Row row;
    row.n = static_cast<std::uint64_t>(256 * size);
    row.errors.rmse = std::pow(10.0, -size);
    row.kernel = {8 * size, 1, 0, 5};
    result.rows.push_back(row);
  }
  result.rate.slope = -1;
  result.rate.intercept = 9;
  result.rate.used = {256, 512};
  const Json json = cell_to_json(test::catalog(), result, nullptr);
  const Json& row = json["rows"][0];
  CHECK(row["seconds_per_replicate"] == 1.0);
  CHECK(row["samples_per_s"] == 256.0);
  CHECK(row["coordinates_per_s"] == 768.0);
  CHECK(row["efficiency"].get<double>() == Approx(100.0));                // 1 / (rmse^2 s)
  CHECK(row["variance_reduction"].get<double>() == Approx(100.0 / 256));  // variance / N / rmse^2
  // Kernel times 8 s and 16 s of 8 replicates at N = 256 and 512.
  CHECK(json["efficiency"]["time_line"]["overhead_s"].get<double>() == Approx(0).margin(1e-12));
  CHECK(json["efficiency"]["time_line"]["seconds_per_sample"].get<double>() == Approx(1.0 / 256));
  CHECK(json["efficiency"]["value"].get<double>() == Approx(1 / (1e-4 * 2)));
  CHECK(json["efficiency"]["at_n"] == 512);
  // RMSE = 512 / N on the fitted line, 0.02 at N = 25600; tolerances are relative to the mean, 2.
  const Json& times = json["efficiency"]["time_to_tolerance"];
  CHECK(json["efficiency"]["relative_to"] == 2.0);
  CHECK(times[1]["tolerance"].get<double>() == Approx(0.01));
  CHECK(times[1]["n"].get<double>() == Approx(25600));
  CHECK(times[1]["seconds"].get<double>() == Approx(100));
  CHECK(times[1]["extrapolated"] == true);
  CHECK(times[1]["octaves_beyond"].get<double>() == Approx(std::log2(50.0)));
}

TEST_CASE("unasked, samples are summed in fp64 where the device has it, else by Kahan", "[unit]") {
  DeviceFacts facts;
  CHECK(make_plan(test::catalog(), cell("linear-prod:d=1", "sobol", 64), facts).sum->name ==
        "double");
  facts.fp64 = false;
  CHECK(make_plan(test::catalog(), cell("linear-prod:d=1", "sobol", 64), facts).sum->name ==
        "kahan");
}
