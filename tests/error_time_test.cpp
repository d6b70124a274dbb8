// Cells compared with plain Monte Carlo, and the Pareto front of a scene: curves computed by hand.
#include "report/error_time.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "error/error.hpp"
#include "journal/cell_json.hpp"
#include "report/results.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

constexpr double kMean = 2;

// A curve of 8 replicates: RMSE = scale N^slope, interval [RMSE / spread, RMSE spread], kernel time
// `per_sample` N of one replicate, at N = 2^8 … 2^16.
struct CurveSpec {
  std::string sampler;
  double slope = -0.5, scale = 1, per_sample = 1e-6, spread = 1;
  Precision precision = Precision::fp64;
  std::uint32_t replicates = 8;
};

CellResult curve(const CurveSpec& spec) {
  CellResult result;
  result.cell = test::cell("linear-prod:d=3", spec.sampler, 256, spec.replicates);
  result.cell.precision = spec.precision;
  result.exact.mean = kMean;
  result.exact.variance = 1;
  result.verdict.verdict = "no-theory";
  result.stability.verdict = "OK";
  for (unsigned m = 8; m <= 16; ++m) {
    Row row;
    row.n = std::uint64_t{1} << m;
    row.log2_block = 8;
    const auto n = static_cast<double>(row.n);
    row.errors.rmse = spec.scale * std::pow(n, spec.slope);
    row.errors.rmse_low = *row.errors.rmse / spec.spread;
    row.errors.rmse_high = *row.errors.rmse * spec.spread;
    row.errors.rmse_interval_method = "chi-squared";
    row.kernel = {spec.replicates * spec.per_sample * n, 0, 0, 1};
    row.wall.count = 1;
    result.rows.push_back(row);
    result.rate.used.push_back(row.n);
  }
  result.rate.slope = spec.slope;
  result.rate.intercept = std::log2(spec.scale);
  result.stopped = {"study", "all", 65536, std::nullopt, 1, std::nullopt, std::nullopt};
  return result;
}

Json results_of(const std::vector<CellResult>& curves) {
  Json cells = Json::array();
  for (const CellResult& c : curves) cells.push_back(cell_to_json(test::catalog(), c, nullptr));
  Study study;
  study.verbatim = Json::object();
  Json results = make_results(make_context(DeviceFacts{}, study, "koksma run"), cells);
  check_schema(results, "results/results.schema.json", "test");
  return results;
}

const CurveSpec kRandom{"random"};
const CurveSpec kOwen{"sobol-owen", -1, 16, 2e-6, 2.5};

}  // namespace

TEST_CASE("the gain over plain Monte Carlo is the ratio of times to the same error", "[unit]") {
  const Json results = results_of({curve(kRandom), curve(kOwen)});
  const Json& owen = results["cells"][1]["efficiency"];
  CHECK(owen["speed_up_over"]["cell"] == 0);
  CHECK(owen["speed_up_over"]["error_by"] == "exact variance");
  CHECK(owen["tolerances"] == "relative");
  CHECK(owen["relative_to"] == kMean);
  // RMSE 2e-3: 16 / N at N = 8000 in 16 ms, 1 / sqrt(N) at N = 250000 in 250 ms.
  const Json& third = owen["time_to_tolerance"][2];
  CHECK(third["tolerance"] == 1e-3);
  CHECK(third["n"].get<double>() == Approx(8000));
  CHECK(third["seconds"].get<double>() == Approx(0.016));
  CHECK(third["speed_up"].get<double>() == Approx(15.625));
  CHECK(third["speed_up_reason"].get<std::string>().empty());
  // Of a row: 1/(MSE time) = N / (16^2 2e-6) over 1e6.
  CHECK(results["cells"][1]["rows"][8]["speed_up"].get<double>() == Approx(65536.0 / 256 / 2));
  CHECK(owen["value"].get<double>() == Approx(65536.0 / 256 / 2e-6));
  const Json& random = results["cells"][0];
  for (const Json& row : random["rows"]) CHECK(row["speed_up"].get<double>() == Approx(1));
  CHECK(random["efficiency"]["time_to_tolerance"][2]["speed_up"].get<double>() == Approx(1));
  CHECK(random["efficiency"]["crossover"]["equal_n"]["n"].is_null());
}

TEST_CASE("the crossover counts what is below Monte Carlo for sure, at equal N and equal time",
          "[unit]") {
  // Upper end 40 / N: below 1 / sqrt(N) from N > 1600; below 1 / sqrt(2 N) from N > 3200.
  const Json results = results_of({curve(kRandom), curve(kOwen)});
  const Json& crossover = results["cells"][1]["efficiency"]["crossover"];
  CHECK(crossover["equal_n"]["n"] == 2048);
  CHECK(crossover["equal_time"]["n"] == 4096);
  // A curve that is twice as good, and uncertain by more, is never below.
  const Json close = results_of({curve(kRandom), curve({"sobol-owen", -0.5, 0.5, 1e-6, 3})});
  CHECK(close["cells"][1]["efficiency"]["crossover"]["equal_n"]["n"].is_null());
  CHECK_THAT(close["cells"][1]["efficiency"]["crossover"]["equal_n"]["reason"].get<std::string>(),
             Contains("not below"));
}

TEST_CASE("at equal N Monte Carlo gets the samples of all randomizations of one estimate",
          "[unit]") {
  // 40 / N is below 1 / sqrt(16 N) from N > 25600.
  Json cells = Json::array();
  for (const CurveSpec& spec : {kRandom, kOwen})
    cells.push_back(cell_to_json(test::catalog(), curve(spec), nullptr));
  cells[1]["plan"] = {{"replicates_per_estimate", 16}};
  Study study;
  study.verbatim = Json::object();
  const Json results = make_results(make_context(DeviceFacts{}, study, "koksma run"), cells);
  const Json& crossover = results["cells"][1]["efficiency"]["crossover"];
  CHECK(crossover["equal_n"]["n"] == 32768);
  CHECK(crossover["equal_time"]["n"] == 4096);  // time is that of the estimate already
}

TEST_CASE("without a known variance the base is the fitted line of its cell", "[unit]") {
  CellResult random = curve({"random", -0.5, 2, 1e-6});
  CellResult owen = curve(kOwen);
  random.exact.variance.reset();
  owen.exact.variance.reset();
  const Json results = results_of({random, owen});
  const Json& json = results["cells"][1]["efficiency"];
  CHECK(json["speed_up_over"]["error_by"] == "fitted line");
  // 2 / sqrt(N) = 2e-3 at N = 10^6, in 1 s.
  CHECK(json["time_to_tolerance"][2]["speed_up"].get<double>() == Approx(62.5));
  CHECK(results["cells"][1]["rows"][8]["speed_up"].get<double>() == Approx(4 * 65536.0 / 256 / 2));
  CHECK(json["crossover"]["equal_n"]["n"] == 512);  // 40 / N < 2 / sqrt(N) from N > 400
}

TEST_CASE("without plain Monte Carlo of the same precision every gain is null with the reason",
          "[unit]") {
  CurveSpec narrow = kRandom;
  narrow.precision = Precision::fp32;
  CellResult unresolved = curve(kRandom);
  unresolved.stability.verdict = "UNRESOLVED";
  for (const std::vector<CellResult>& curves :
       {std::vector{curve(kOwen)}, {curve(kOwen), curve(narrow)}, {curve(kOwen), unresolved}}) {
    const Json results = results_of(curves);
    const Json& json = results["cells"][0]["efficiency"];
    CHECK(json["speed_up_over"]["cell"].is_null());
    CHECK_THAT(json["speed_up_over"]["reason"].get<std::string>(), Contains("no resolved cell"));
    for (const Json& t : json["time_to_tolerance"]) {
      CHECK(t["speed_up"].is_null());
      CHECK(t["speed_up_reason"] == json["speed_up_over"]["reason"]);
    }
    for (const Json& row : results["cells"][0]["rows"]) CHECK(row["speed_up"].is_null());
  }
}

TEST_CASE("the front of a scene names the cell and N of what nothing beats", "[unit]") {
  const Json results = results_of({curve(kRandom), curve(kOwen)});
  REQUIRE(results["scenes"].size() == 1);
  const Json& scene = results["scenes"][0];
  CHECK(scene["scene"] == "linear-prod:d=3");
  CHECK(scene["points"] == 18);
  REQUIRE(scene["front"].size() == 11);
  // random at 256 and 512 us (1/16, 1/22.6); sobol-owen at 512 us has 1/16: beaten. At 1024 us
  // 1/32 and 1/32 are equal: both.
  const std::vector<std::pair<int, std::uint64_t>> expected{
      {0, 256}, {0, 512}, {0, 1024}, {1, 512}};
  for (std::size_t k = 0; k < expected.size(); ++k) {
    INFO(k << " " << scene["front"][k].dump());
    CHECK(scene["front"][k]["cell"] == expected[k].first);
    CHECK(scene["front"][k]["n"] == expected[k].second);
  }
  for (std::size_t k = 4; k < 11; ++k) CHECK(scene["front"][k]["cell"] == 1);
  CHECK(scene["front"].back()["n"] == 65536U);
  CHECK(scene["front"] == scene["front_replicated"]);
}

TEST_CASE("a single point set is on the front, and not on that of replicated ones", "[unit]") {
  CurveSpec single{"sobol", -1, 1e-3, 1e-7};
  single.replicates = 1;
  const Json results = results_of({curve(kOwen), curve(single)});
  const Json& scene = results["scenes"][0];
  for (const Json& point : scene["front"]) CHECK(point["sampler"] == "sobol");
  CHECK(scene["front_replicated"].size() == 9);
  for (const Json& point : scene["front_replicated"]) CHECK(point["sampler"] == "sobol-owen");
}

TEST_CASE("rows whose error is not believed are on no front, and a scene without others says so",
          "[unit]") {
  CellResult owen = curve(kOwen);
  for (Row& row : owen.rows) {
    row.unresolved = "test";
    row.errors.rmse_interval_method = "unresolved";
  }
  owen.rows.back().unresolved.clear();
  owen.rows.back().errors.rmse_interval_method = "chi-squared";
  owen.rows.back().below_reference = true;
  const Json results = results_of({owen});
  CHECK(results["scenes"][0]["points"] == 0);
  CHECK(results["scenes"][0]["front"].empty());
  CHECK_FALSE(results["scenes"][0]["reason"].get<std::string>().empty());
  CHECK(results["cells"][0]["efficiency"]["value"].is_null());
}

TEST_CASE("the schema refuses a null without a reason, and a reason beside a number", "[unit]") {
  const Json good = results_of({curve(kRandom), curve(kOwen)});
  const auto refused = [&](const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad["cells"][1]);
    CHECK_THROWS_AS(check_schema(bad, "results/results.schema.json", "test"), InputError);
  };
  const auto tolerance = [](Json& cell) -> Json& {
    return cell["efficiency"]["time_to_tolerance"][2];
  };
  refused([](Json& cell) { cell["efficiency"]["value"] = nullptr; });
  refused([&](Json& cell) { tolerance(cell)["seconds"] = nullptr; });
  refused([&](Json& cell) { tolerance(cell)["reason"] = "because"; });
  refused([&](Json& cell) { tolerance(cell)["speed_up"] = nullptr; });
  refused([&](Json& cell) { tolerance(cell)["n"] = 0.5; });
  refused([](Json& cell) { cell["efficiency"]["time_to_tolerance"].erase(11); });
  refused([](Json& cell) { cell["efficiency"]["crossover"]["equal_n"]["n"] = nullptr; });
  refused([](Json& cell) { cell["efficiency"]["speed_up_over"]["cell"] = nullptr; });
  refused([](Json& cell) { cell["stopped"]["by"] = "tired"; });
  Json bad = good;
  bad["scenes"][0]["front"].clear();
  CHECK_THROWS_AS(check_schema(bad, "results/results.schema.json", "test"), InputError);
}
