// Integrands whose integral nobody gives: errors are against the run's own best estimate, and every
// row says so.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "estimate/measure.hpp"
#include "estimate/reference.hpp"
#include "journal/cell_json.hpp"
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
    return run_study("--scene bell:d=2 --n 2^8..2^14 " + arguments);
  }
  Json run_study(const std::string& arguments) {
    const auto result = run_command(fmt::format("run --integrand {} --out {} {}",
                                                folder.path("bell.json"), results, arguments));
    INFO(result.output);
    REQUIRE(result.status == 0);
    output = result.output;
    return parse_json(read_text_file(results), results);
  }
  std::string output;
};

const double kIntegral = std::pow(std::sqrt(std::acos(-1.0)) / 2 * std::erf(1.0), 2);

void check_measured_against_itself(const Json& row) {
  CHECK(row["error_reason"] == "measured against itself");
  CHECK(row["error_against"] == "own best estimate");
  for (const char* key : {"rmse", "rmse_interval", "median_abs_error", "bias", "rho", "efficiency",
                          "variance_reduction", "speed_up"}) {
    INFO(key);
    CHECK(row[key].is_null());
  }
}

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
  check_measured_against_itself(best["rows"].back());
  CHECK(best["convergence"]["rows_excluded"].back() ==
        Json{{"n", 16384}, {"reason", "measured against itself"}});
  CHECK(cell_of(results, "random")["reference"]["from"] ==
        "sobol-owen with rqmc, N = 16384, 32 replicates");
  CHECK(cell_of(results, "random")["reference"]["standard_error"] ==
        best["rows"].back()["standard_error"]);
  const double bias = cell_of(results, "sobol")["rows"][0]["bias"];
  const double estimate = cell_of(results, "sobol")["rows"][0]["estimate"];
  CHECK(bias == Approx(estimate - value).epsilon(1e-12));
}

TEST_CASE("alone, a cell is measured against its own last estimate, which has no error itself",
          "[device]") {
  OwnIntegrand own(R"({"from": "none"})");
  const Json repeated = own.run("--sampler random")["cells"][0];
  CHECK(own.output.find("measured against itself") != std::string::npos);
  CHECK(repeated["reference"]["from"] == "this cell at N = 16384");
  CHECK(repeated["reference"]["standard_error"].get<double>() > 0);
  check_measured_against_itself(repeated["rows"].back());
  CHECK(repeated["rows"].back()["estimate"].is_number());
  CHECK(repeated["rows"][0]["rmse"].get<double>() > 0);
  CHECK(repeated["rows"][0]["error_reason"].get<std::string>().empty());
  CHECK(repeated["convergence"]["rate"].is_number());

  // A single set's errors are differences between its own prefixes.
  const Json single = own.run("--sampler sobol")["cells"][0];
  CHECK(single["reference"]["from"] == "this cell at N = 16384; error of the reference unknown");
  CHECK(single["reference"]["standard_error"].is_null());
  check_measured_against_itself(single["rows"].back());
  CHECK(single["convergence"]["rate"].is_null());
  CHECK(single["convergence"]["reason"] == "measured against itself");
  CHECK(single["convergence"]["rows_excluded"].size() == single["rows"].size());
}

TEST_CASE("rows below the reference's error are marked, rated by nothing, and no plateau",
          "[device]") {
  // A coarse reference; sobol at 2^16 is far better. Of the median, the error is from its interval.
  const std::string best = GENERATE(R"("samplers": ["sobol-owen"], "estimator": "rqmc")",
                                    R"("samplers": ["sobol-lms-shift"], "estimator": "median")");
  OwnIntegrand own(R"({"from": "none"})");
  const std::string study = own.folder.write("study.json", fmt::format(R"({{"cells": [
        {{"scenes": ["bell:d=2"], {}, "n": "2^8", "replicates": 4}},
        {{"scenes": ["bell:d=2"], "samplers": ["sobol"], "n": "2^8..2^18"}}]}})",
                                                                       best));
  const Json results = own.run_study(study);
  INFO(best);
  CHECK(own.output.find("below the reference's error") != std::string::npos);
  const Json& cell = cell_of(results, "sobol");
  const double error = cell["reference"]["standard_error"];
  CHECK(error > 0);
  const std::string from = cell["reference"]["from"];
  CHECK((from.find("its error is from its interval") != std::string::npos) ==
        (best.find("median") != std::string::npos));
  std::size_t below = 0;
  for (const Json& row : cell["rows"]) {
    INFO(row["n"]);
    CHECK(row["error_against"] == "own best estimate");
    CHECK(row["below_reference"] == (row["rmse"].get<double>() < 3 * error));
    CHECK(row["efficiency"].is_null() == row["below_reference"].get<bool>());
    CHECK(row["error_reason"].get<std::string>().empty() != row["below_reference"].get<bool>());
    below += row["below_reference"].get<bool>() ? 1 : 0;
  }
  CHECK(below >= 4);
  CHECK(below < cell["rows"].size());
  CHECK(cell["convergence"]["rows_excluded"].size() >= below);
  CHECK(cell["stability"]["plateau"]["kind"] != "structural");
}

TEST_CASE("a curve that ends flat at a reference of unknown error is no plateau", "[device]") {
  OwnIntegrand own(R"({"from": "none"})");
  const Json results = own.run_study(own.folder.write("study.json", R"({"cells": [
    {"scenes": ["bell:d=2"], "samplers": ["sobol"], "n": "2^8", "precision": "fp64"},
    {"scenes": ["bell:d=2"], "samplers": ["halton"], "n": "2^8..2^18", "precision": "fp32"}]})"));
  const Json& cell = cell_of(results, "halton");
  CHECK(cell["reference"]["standard_error"].is_null());
  CHECK(cell["reference"]["from"].get<std::string>().find("unknown") != std::string::npos);
  CHECK(cell["stability"]["plateau"]["kind"] == "none");
  CHECK(cell["stability"]["plateau"]["reason"].get<std::string>().find("it is unknown") !=
        std::string::npos);
}

TEST_CASE("no time is given to a tolerance below three errors of the reference", "[unit]") {
  CellResult result;
  result.cell = test::cell("genz-gaussian:d=2", "sobol", 1 << 12);
  result.reference = Reference{1, 1e-3, "test"};
  Row row;
  row.n = 4096;
  row.kernel.median = row.wall.median = 1;
  row.errors.rmse = 1e-2;
  result.rows.push_back(row);
  result.rate.slope = -1;
  result.rate.intercept = 5;
  result.rate.used = {256, 4096};
  result.floor = result.reference->error.value();
  const auto time = [&](int digits) {
    return cell_to_json(
        test::catalog(), result,
        nullptr)["efficiency"]["time_to_tolerance"][static_cast<std::size_t>(digits - 1)];
  };
  CHECK(time(2)["seconds"].is_number());
  CHECK(time(3)["seconds"].is_null());
  CHECK(time(3)["reason"].get<std::string>().find("floor") != std::string::npos);
  result.floor = 1e-4;
  CHECK(time(3)["n"].get<double>() == Approx(32000));
}

TEST_CASE("the error of a reference is its standard error, else that of its interval, else unknown",
          "[unit]") {
  const Reference known = make_reference(2, 0.5, Interval{0, 4}, "x");
  CHECK(known.error == 0.5);
  CHECK(known.from == "x");
  const Reference order = make_reference(2, std::nullopt, Interval{1.5, 3.5}, "x");
  CHECK(*order.error == Approx(1 / 1.96));
  CHECK(order.from == "x; its error is from its interval");
  const Reference single = make_reference(2, std::nullopt, std::nullopt, "x");
  CHECK_FALSE(single.error);
  CHECK(single.from == "x; error of the reference unknown");
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
  // Independent samples last among those with an interval, single sets after them.
  CHECK(by_promise(test::catalog(), cells, {0, 1, 2, 3, 4}) ==
        std::vector<std::size_t>{3, 2, 4, 1, 0});
}

TEST_CASE("of equal rates, Student's t over linear scrambles is trusted less, their median not",
          "[unit]") {
  const std::string scene = "genz-gaussian:d=2";
  const std::vector<Cell> cells{test::cell(scene, "sobol-lms-shift", 1 << 14, 32),
                                test::cell(scene, "sobol-owen", 1 << 12, 32),
                                test::cell(scene, "sobol-shift", 1 << 16, 32),
                                test::cell(scene, "sobol-lms-shift", 1 << 14, 32, "median")};
  CHECK(by_promise(test::catalog(), cells, {0, 1, 2, 3}) == std::vector<std::size_t>{3, 1, 0, 2});
}
