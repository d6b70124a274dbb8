// koksma report: results in the formats of other tools hold the numbers of the results.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "report/writers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

Json recorded_small() {
  return parse_json(test::repository_file("results/default-study.json"), "recorded");
}

std::size_t rows_of(const Json& results) {
  std::size_t rows = 0;
  for (const Json& cell : results["cells"]) rows += cell["rows"].size();
  return rows;
}

}  // namespace

TEST_CASE("Google Benchmark's format has an entry per row, with its times in ns and its counters",
          "[unit]") {
  Json results = recorded_small();
  results["cells"][1]["status"] = "failed";
  results["cells"][1]["reason"] = "out of memory";
  results["cells"][1]["rows"] = Json::array();
  const Json json = google_benchmark_json(results);
  for (const char* key : {"date", "host_name", "executable", "num_cpus", "library_build_type"})
    CHECK(json["context"].contains(key));
  REQUIRE(json["benchmarks"].size() == rows_of(results) + 1);
  const Json& row = results["cells"][0]["rows"][3];
  const Json& entry = json["benchmarks"][3];
  CHECK(entry["run_type"] == "iteration");
  CHECK(entry["name"] == entry["run_name"]);
  CHECK_THAT(entry["name"].get<std::string>(),
             Catch::StartsWith(results["cells"][0]["scene"]["text"].get<std::string>()) &&
                 Contains(row["n"].dump()));
  CHECK(entry["time_unit"] == "ns");
  CHECK(entry["iterations"] == row["kernel_s"]["count"]);
  CHECK(entry["real_time"].get<double>() == Approx(row["kernel_s"]["median"].get<double>() * 1e9));
  CHECK(entry["cpu_time"].get<double>() == Approx(row["wall_s"]["median"].get<double>() * 1e9));
  CHECK(entry["rmse"] == row["rmse"]);
  CHECK(entry["items_per_second"] == row["samples_per_s"]);
  std::set<std::string> names;
  std::size_t errors = 0;
  for (const Json& e : json["benchmarks"]) {
    CHECK(names.insert(e["name"].get<std::string>()).second);
    errors += e.contains("error_occurred");
    for (const auto& [key, value] : e.items()) CHECK_FALSE(value.is_null());
  }
  CHECK(errors == 1);
}

TEST_CASE("charts get a time and an error per row, each with name, unit, value, range and extra",
          "[unit]") {
  const Json results = recorded_small();
  const Json json = chart_json(results);
  CHECK(json.size() > rows_of(results));
  std::set<std::string> names;
  for (const Json& e : json) {
    CHECK(names.insert(e["name"].get<std::string>()).second);
    CHECK(e["value"].is_number());
    CHECK(e["extra"].is_string());
    CHECK((!e.contains("range") || e["range"].is_string()));
  }
  const Json& row = results["cells"][0]["rows"][0];
  CHECK(json[0]["unit"] == "us");
  CHECK(json[0]["value"].get<double>() == Approx(row["kernel_s"]["median"].get<double>() * 1e6));
  CHECK_THAT(json[0]["range"].get<std::string>(), Catch::StartsWith("± "));
  // The range of an error is half its interval.
  std::size_t with_range = 0;
  for (const Json& cell : results["cells"]) {
    for (const Json& r : cell["rows"]) {
      if (!r["rmse"].is_number() || !r["rmse_interval"].is_array()) continue;
      const double half =
          (r["rmse_interval"][1].get<double>() - r["rmse_interval"][0].get<double>()) / 2;
      const auto found = std::find_if(json.begin(), json.end(), [&](const Json& e) {
        return e["unit"] == "RMSE" && e["value"] == r["rmse"] && e.contains("range");
      });
      REQUIRE(found != json.end());
      CHECK((*found)["range"] == fmt::format("± {:.3g}", half));
      ++with_range;
    }
  }
  CHECK(with_range > 0);
}

TEST_CASE("the command writes each format and refuses others with those that there are", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string results = fmt::format("{}/results/default-study.json", KOKSMA_SOURCE_DIR);
  for (const std::string& format : report_formats()) {
    const auto made = test::run_command("report " + results + " --format " + format + " -o " +
                                        folder.path(format + ".json"));
    INFO(made.output);
    CHECK(made.status == 0);
    CHECK_FALSE(parse_json(read_text_file(folder.path(format + ".json")), format).empty());
  }
  for (const char* flags : {"", " --format html"}) {
    const auto refused =
        test::run_command("report " + results + flags + " -o " + folder.path("report.html"));
    INFO(refused.output);
    CHECK(refused.status == 2);
    for (const std::string& format : report_formats()) CHECK_THAT(refused.output, Contains(format));
  }
}
