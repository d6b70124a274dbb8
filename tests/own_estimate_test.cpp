// Integrands whose integral nobody gives: errors are against the run's own best estimate, and every
// row says so.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "estimate/reference.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::run_command;

namespace {

// prod exp(-x_j^2); `exact` is the entry's /exact/mean.
struct OwnIntegrand {
  test::TemporaryFolder folder;
  std::string results = folder.path("results.json");

  explicit OwnIntegrand(const std::string& exact) {
    folder.write("bell.cl",
                 "static inline real integrand(points *p, params q, coefficients c) {\n"
                 "  real product = R(1.0);\n"
                 "  for (uint j = 0; j < KOKSMA_DIM; ++j) {\n"
                 "    const real x = points_next(p);\n"
                 "    product *= exp(-x * x);\n"
                 "  }\n"
                 "  return product;\n"
                 "}\n");
    folder.write("bell.json", fmt::format(R"({{
      "name": "bell", "title": "Bell", "citation": "test", "reference": [], "class": "smooth",
      "periodic": false, "parameters": [], "dimensions": {{"min": 1, "max": 9, "default": 2}},
      "draws": "d", "coefficients": [], "transforms": [], "exact_operations": false,
      "nonnegative": true, "checks": [], "exact": {{"mean": {}, "variance": {{"from": "none"}},
      "mean_abs": {{"from": "mean"}}}}}})",
                                          exact));
  }

  Json run(const std::string& arguments) {
    const auto result =
        run_command(fmt::format("run --integrand {} --scene bell:d=2 --n 2^8..2^13 --out {} {}",
                                folder.path("bell.json"), results, arguments));
    INFO(result.output);
    REQUIRE(result.status == 0);
    output = result.output;
    return parse_json(read_text_file(results), results);
  }
  std::string output;
};

const double kIntegral = std::pow(std::sqrt(std::acos(-1.0)) / 2 * std::erf(1.0), 2);

const Json& cell_of(const Json& results, const std::string& sampler) {
  for (const Json& cell : results["cells"])
    if (cell["sampler"] == sampler) return cell;
  throw std::runtime_error("no cell of " + sampler);
}

}  // namespace

TEST_CASE("without an exact value, errors are against the cell that theory trusts most",
          "[device]") {
  OwnIntegrand own(R"({"from": "none"})");
  const Json results = own.run("--sampler random --sampler sobol --sampler sobol-owen");
  CHECK(own.output.find("own-estimate: the integral is not known") != std::string::npos);
  const Json& best = cell_of(results, "sobol-owen");
  const double value = best["rows"].back()["estimate"];
  CHECK(std::fabs(value - kIntegral) < 1e-6);
  for (const Json& cell : results["cells"]) {
    INFO(cell["sampler"]);
    CHECK(cell["reference"]["value"] == value);
    CHECK(cell["scene"]["exact"]["mean"]["value"].is_null());
    for (const Json& row : cell["rows"]) CHECK(row["error_against"] == "own best estimate");
    // The slopes are those against the truth.
    const double expected = cell["sampler"] == "random"  ? -0.5
                            : cell["sampler"] == "sobol" ? -1
                                                         : -1.44;
    CHECK(cell["convergence"]["rate"].get<double>() == Approx(expected).margin(0.2));
  }
  CHECK(cell_of(results, "random")["reference"]["from"] ==
        "sobol-owen with rqmc, N = 8192, 32 replicates");
  const double bias = cell_of(results, "sobol")["rows"][0]["bias"];
  const double estimate = cell_of(results, "sobol")["rows"][0]["estimate"];
  CHECK(bias == Approx(estimate - value).epsilon(1e-12));
}

TEST_CASE("alone, a cell is measured against its own last estimate", "[device]") {
  OwnIntegrand own(R"({"from": "none"})");
  const Json results = own.run("--sampler random");
  const Json& cell = cell_of(results, "random");
  CHECK(cell["reference"]["from"] == "this cell at N = 8192");
  CHECK(cell["rows"].back()["bias"].get<double>() == Approx(0).margin(1e-15));
  CHECK(cell["rows"][0]["rmse"].get<double>() > 0);
}

TEST_CASE("a constant in the entry is the exact value", "[device]") {
  OwnIntegrand own(fmt::format(R"({{"from": "constant", "value": "{:.17f}"}})", kIntegral));
  const Json results = own.run("--sampler sobol-owen");
  const Json& cell = results["cells"][0];
  CHECK(cell["reference"].is_null());
  CHECK(cell["scene"]["exact"]["mean"]["value"].get<double>() == Approx(kIntegral).epsilon(1e-16));
  for (const Json& row : cell["rows"]) CHECK(row["error_against"] == "exact value");
}

TEST_CASE("a constant without a value is an error at its place", "[unit]") {
  OwnIntegrand own(R"({"from": "constant"})");
  const auto result =
      run_command(fmt::format("run --integrand {} --scene bell", own.folder.path("bell.json")));
  CHECK(result.status == 2);
  CHECK(result.output.find("bell.json, at '/exact/mean': a constant without a value") !=
        std::string::npos);
}

TEST_CASE("the reference is the cell with the best promise", "[unit]") {
  std::vector<Cell> cells{test::cell("genz-gaussian:d=2", "sobol", 1 << 12),
                          test::cell("genz-gaussian:d=2", "random", 1 << 20, 32),
                          test::cell("genz-gaussian:d=2", "sobol-owen", 1 << 8, 32),
                          test::cell("genz-gaussian:d=2", "sobol-owen", 1 << 10, 32),
                          test::cell("genz-gaussian:d=2", "sobol-owen", 1 << 12, 32)};
  cells[4].precision = Precision::fp32;
  CHECK(by_promise(test::catalog(), cells, {0, 1, 2, 3, 4}) ==
        std::vector<std::size_t>{3, 2, 1, 4, 0});
}
