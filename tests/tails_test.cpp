// What heavy tails and unresolved cells may not publish: whole cells on the device.
#include <catch2/catch.hpp>
#include <cmath>

#include "catalog/embedded.hpp"
#include "estimate/measure.hpp"
#include "journal/cell_json.hpp"
#include "report/results.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

struct Run {
  CellResult result;
  Json json;
};

Run run(const Catalog& catalog, const Cell& cell) {
  PreparedCell prepared(catalog, test::device(), test::device(),
                        make_plan(catalog, cell, test::device().facts()));
  Run run{prepared.run(), {}};
  run.json = cell_to_json(catalog, run.result, &prepared.plan());
  return run;
}

Run run(const std::string& scene, const std::string& sampler, const std::string& sizes,
        std::uint64_t seed = 1, const std::string& estimator = "") {
  Cell cell = test::cell(scene, sampler, 256, 32, estimator);
  cell.n = parse_sizes(sizes, "test");
  cell.seed = seed;
  return run(test::catalog(), cell);
}

// An embedded integrand whose entry and code are changed, as the user's "mine".
struct Mine {
  test::TemporaryFolder folder;
  Json entry;
  std::string code;

  explicit Mine(const std::string& model) {
    const Integrand& f = test::catalog().integrand(model, "test");
    entry =
        parse_json(embedded_text(f.code.path.substr(0, f.code.path.size() - 3) + ".json"), "test");
    entry["name"] = "mine";
    entry["checks"] = Json::array();
    code = f.code.text;
  }
  void replace(const std::string& from, const std::string& to) {
    REQUIRE(code.find(from) != std::string::npos);
    code.replace(code.find(from), from.size(), to);
  }
  Run run(const std::string& parameters, const std::string& sizes) const {
    folder.write("mine.cl", code);
    const Catalog catalog = load_catalog({folder.write("mine.json", entry.dump())});
    Cell cell = test::cell("linear-prod:d=1", "random", 256, 32);
    cell.scene = parse_scene(catalog, "mine:" + parameters, "test");
    cell.n = parse_sizes(sizes, "test");
    return ::run(catalog, cell);
  }
};

bool marked(const Row& row) { return row.estimate.reason.rfind("may cover less", 0) == 0; }

}  // namespace

TEST_CASE("heavy tails are neither tested against their variance nor given unmarked intervals",
          "[device]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const CellResult result = run("lognormal:sigma=3", "random", "2^18", seed).result;
    INFO("seed " << seed << ": " << result.stability.reason);
    CHECK(result.stability.verdict == "OK");
    CHECK_FALSE(result.rows[0].mc_test.applicable);
    CHECK_FALSE(result.rows[0].mc_test.reason.empty());
    CHECK(result.rows[0].estimate.interval);
    CHECK(marked(result.rows[0]));
  }
  // An event that none of the first values shows.
  Mine jump("gauss-ridge-jump");
  jump.entry["exact"].erase("kurtosis");
  const CellResult rare = jump.run("d=2,tau=-4", "2^17").result;
  CHECK_FALSE(rare.rows[0].mc_test.applicable);
  CHECK(marked(rare.rows[0]));
  const CellResult light = run("genz-gaussian:d=2", "random", "2^12").result;
  CHECK(light.rows[0].mc_test.applicable);
  CHECK(light.rows[0].estimate.reason.empty());
}

TEST_CASE("an entry may state the kurtosis of its f", "[device]") {
  Mine mine("simplex-indicator");
  mine.entry["exact"].erase("kurtosis");
  // Variance 1e-3, excess 995: no estimate of 4096 values tells that.
  const auto first = [&](const std::string& parameters, const std::string& sizes) {
    return mine.run(parameters, sizes).result.rows[0];
  };
  CHECK_FALSE(first("d=1,t=0.999", "2^14").mc_test.applicable);
  mine.entry["exact"]["kurtosis"] = {{"from", "indicator"}};
  const Row common = first("d=1,t=0.999", "2^14");
  CHECK(common.mc_test.applicable);
  CHECK(common.estimate.reason.empty());
  CHECK(first("d=1,t=0.999", "2^12").mc_test.reason == "excess kurtosis / N is not below 0.1");
  CHECK_FALSE(first("d=5,t=4.9", "2^17").mc_test.applicable);
  mine.entry["exact"]["kurtosis"] = {{"from", "unknown"}};
  const Row unknown = first("d=1,t=0.5", "2^14");
  CHECK(unknown.mc_test.reason == "the fourth moment of f is infinite or unknown");
  CHECK(unknown.estimate.reason == "may cover less: the fourth moment of f is infinite or unknown");
}

TEST_CASE("intervals of strata and of pairs are marked where f has a heavy tail", "[device]") {
  for (const char* sampler : {"stratified-pairs", "random-antithetic"}) {
    const CellResult heavy = run("lognormal:sigma=2.5", sampler, "2^12..2^16").result;
    for (const Row& row : heavy.rows) {
      INFO(sampler << " N = " << row.n << ": " << row.estimate.reason);
      CHECK((!row.estimate.interval || marked(row)));
    }
    CHECK(heavy.rows.back().estimate.interval);
    const CellResult light = run("genz-gaussian:d=1", sampler, "2^12").result;
    CHECK(light.rows[0].estimate.interval);
    CHECK(light.rows[0].estimate.reason.empty());
  }
}

TEST_CASE("an unresolved cell publishes nothing that rests on its RMSE", "[device]") {
  const Run unresolved = run("prod-2x:d=100", "random", "2^12..2^14");
  CHECK(unresolved.result.stability.verdict == "UNRESOLVED");
  const Json results =
      make_results(make_context(test::device().facts(), Study{}, "test"),
                   Json::array({unresolved.json, run("prod-2x:d=100", "sobol", "2^12").json,
                                run("prod-2x:d=2", "random", "2^12").json}));
  for (const std::size_t cell : {0U, 1U}) {
    for (const Json& row : results["cells"][cell]["rows"]) {
      for (const char* key : {"rmse_interval", "efficiency", "variance_reduction", "speed_up"}) {
        INFO(key);
        CHECK(row[key].is_null());
      }
      CHECK(row["rmse_interval_method"] == "unresolved");
      CHECK(row["rmse"].is_number());
    }
    for (const Json& time : results["cells"][cell]["efficiency"]["time_to_tolerance"])
      CHECK(time["seconds"].is_null());
    CHECK_THAT(results["cells"][cell]["efficiency"]["speed_up_over"]["reason"].get<std::string>(),
               StartsWith("no resolved cell"));
  }
  const Json& good = results["cells"][2]["rows"][0];
  CHECK(good["speed_up"].get<double>() == Approx(1).epsilon(0.8));
  CHECK(good["rmse_interval"].is_array());
}

TEST_CASE("the variance reduction of a median counts all samples of its randomizations",
          "[device]") {
  const Run median = run("genz-gaussian:d=2", "sobol-lms-shift", "2^10", 1, "median");
  const Row& row = median.result.rows[0];
  CHECK(median.json["rows"][0]["variance_reduction"].get<double>() ==
        Approx(*median.result.exact.variance / (15 * 1024 * *row.errors.rmse * *row.errors.rmse)));
}

TEST_CASE("a variance above the range of double leaves a cell unresolved", "[device]") {
  Mine mine("lognormal");
  mine.replace("return exp(q.sigma * q.sigma) * expm1(q.sigma * q.sigma);",
               "return q.sigma > 1 ? INFINITY : 1;");
  const Run overflow = mine.run("sigma=2", "2^8..2^13");
  CHECK(overflow.result.exact.variance_overflows);
  CHECK_FALSE(overflow.result.exact.infinite_variance);
  CHECK(overflow.result.stability.verdict == "UNRESOLVED");
  CHECK(*overflow.result.stability.n_eff == 0);
  CHECK(overflow.json["scene"]["exact"]["variance"]["value"].is_null());
  CHECK_FALSE(mine.run("sigma=1", "2^8").result.exact.variance_overflows);
  mine.entry["exact"]["variance"]["infinite"] = true;
  const Run infinite = mine.run("sigma=2", "2^8");
  CHECK(infinite.result.exact.infinite_variance);
  CHECK_FALSE(infinite.result.exact.variance_overflows);
}

TEST_CASE("an infinite mean is one where the entry says so", "[device]") {
  Mine mine("lognormal");
  mine.replace("return exp(q.sigma * q.sigma / 2);", "return q.sigma > 1 ? INFINITY : 1;");
  CHECK_FALSE(mine.run("sigma=2", "2^8").result.exact.mean_undefined);
  mine.entry["exact"]["mean"]["infinite"] = true;
  const Run run = mine.run("sigma=2", "2^8");
  CHECK(run.result.exact.mean_undefined);
  CHECK_FALSE(run.result.exact.mean);
  CHECK(run.result.stability.verdict == "NOT_INTEGRABLE");
  CHECK(mine.run("sigma=1", "2^10").result.exact.mean == 1.0);
}
