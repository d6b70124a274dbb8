// koksma compare: what counts as a regression, on a recorded study with times made by a known law.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "report/compare.hpp"
#include "report/compare_report.hpp"
#include "report/compare_times.hpp"
#include "report/results.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;
using test::run_command;

namespace {

// Times of 12 rounds of a machine that drifts by a factor of two within the run and between runs,
// with 5 % of noise, and launches that meet somebody else's and take up to twice as long; times
// `factor`.
Json timed(std::uint64_t seed, double factor = 1) {
  Json results = test::recorded_study();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 0.05);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double phase = 6.28 * uniform(random);
  double clock = 0;
  for (Json& cell : results["cells"]) {
    for (Json& row : cell["rows"]) {
      row["kernel_times_s"] = row["calibration_s"] = Json::array();
      for (int round = 0; round < 12; ++round) {
        clock += 0.01;
        const double drift = std::exp2(0.5 + 0.5 * std::sin(phase + clock));
        const double hit = uniform(random) < 0.1 ? 1 + uniform(random) : 1;
        row["kernel_times_s"].push_back(factor * 1e-8 * row["n"].get<double>() * drift * hit *
                                        std::exp(normal(random)));
        row["calibration_s"].push_back(1e-4 * drift * std::exp(normal(random)));
      }
    }
  }
  return results;
}

Comparison compared(const Json& base, const Json& now, CompareOptions options = {}) {
  return compare_results(base, now, options);
}

Json& row_of(Json& results, std::size_t cell, std::size_t row) {
  return results["cells"][cell]["rows"][row];
}

std::size_t deterministic_cell(const Json& results) {
  for (std::size_t i = 0; i < results["cells"].size(); ++i)
    if (results["cells"][i]["estimator"] == "qmc") return i;
  FAIL("the default study has no cell of one point set");
  return 0;
}

std::size_t row_with_interval(const Json& cell) {
  for (std::size_t i = 0; i < cell["rows"].size(); ++i)
    if (cell["rows"][i]["rmse_interval"].is_array()) return i;
  FAIL("no row has an interval");
  return 0;
}

}  // namespace

TEST_CASE("two runs of one build on a machine that drifts by a factor of two do not differ",
          "[statistical]") {
  // 100 pairs. The threshold is more than five standard deviations of a row's ratio (0.07 /
  // sqrt(12) times sqrt 2, a little more for the hits): below 1e-6 for all rows together.
  int alarms = 0;
  for (std::uint64_t k = 0; k < 100; ++k)
    alarms += compared(timed(2 * k), timed(2 * k + 1)).regression();
  CHECK(alarms == 0);
  // Half as fast a machine is the same to a calibrated comparison, and slower to any other.
  Json base = timed(0), now = timed(1);
  for (Json& cell : now["cells"])
    for (Json& row : cell["rows"])
      for (const char* key : {"kernel_times_s", "calibration_s"})
        for (Json& t : row[key]) t = 2 * t.get<double>();
  CHECK_FALSE(compared(base, now).regression());
  CHECK(compared(base, now).calibration_ratio > 1.2);
  for (Json* results : {&base, &now})
    for (Json& cell : (*results)["cells"])
      for (Json& row : cell["rows"]) row.erase("calibration_s");
  const Comparison bare = compared(base, now);
  CHECK(bare.regression());
}

TEST_CASE("a slowdown of 30 % of everything, of one cell and of one row is found",
          "[statistical]") {
  // 60 pairs each; all are found here, and a power of 0.95 would give 60 of 60 with 0.05 only.
  int everything = 0, cell = 0, row = 0, small = 0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    const Json base = timed(2 * k);
    const Comparison all = compared(base, timed(2 * k + 1, 1.3));
    everything += all.regression() && all.study.change == Change::worse;
    Json slow_cell = timed(2 * k + 1), slow_row = slow_cell, slower = slow_cell;
    for (Json& r : slow_cell["cells"][1]["rows"])
      for (Json& t : r["kernel_times_s"]) t = 1.3 * t.get<double>();
    const Comparison one = compared(base, slow_cell);
    cell += one.cells[1].time.change == Change::worse && one.study.change == Change::none;
    for (Json& t : row_of(slow_row, 2, 3)["kernel_times_s"]) t = 2.5 * t.get<double>();
    const Comparison single = compared(base, slow_row);
    row += single.cells[2].rows[3].time.change == Change::worse &&
           single.cells[2].time.change == Change::none;
    for (Json& c : slower["cells"])
      for (Json& r : c["rows"])
        for (Json& t : r["kernel_times_s"]) t = 1.08 * t.get<double>();
    small += compared(base, slower).study.change != Change::none;
  }
  CHECK(everything == 60);
  CHECK(cell >= 57);
  CHECK(row >= 57);
  CHECK(small == 0);  // 8 % are below the threshold, however sure
}

TEST_CASE("a spread seen in few ratios lets more pass as noise than one that is known", "[unit]") {
  // 20 % by one of a hundred tests, 3.7 times the spread: beyond a normal variable's 3.09 at 0.001,
  // and beyond Student's 3.17 of 100 degrees of freedom, not beyond the 5.2 of 6.
  const auto decided = [](double spread, double dof, double ratio = 1.2) {
    TimeChange time;
    time.ratio = ratio;
    time.p = 1e-9;
    decide(time, 0.15, 0.001, spread, dof);
    return time.change;
  };
  const double spread = std::log(1.2) / 3.7;
  CHECK(decided(spread, 100) == Change::worse);
  CHECK(decided(spread, 6) == Change::none);
  CHECK(decided(spread, 6, 1.35) == Change::worse);
  CHECK(decided(spread, 6, 1 / 1.35) == Change::better);
  CHECK(decided(0, 1) == Change::worse);
  // The degrees of freedom are those of spread_of: over many samples of 40 normal variables the
  // relative variance of what it sees is 1 / (2 dof). 2000 samples: known to 0.035 of itself, four
  // standard errors and a tenth for the asymptotic formula.
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.1);
  double sum = 0, squares = 0;
  constexpr int kSamples = 2000;
  constexpr std::size_t kRatios = 40;
  for (int k = 0; k < kSamples; ++k) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < kRatios; ++i) ratios.push_back(std::exp(normal(random)));
    const double seen = spread_of(ratios);
    sum += seen;
    squares += seen * seen;
  }
  const double mean = sum / kSamples, variance = squares / kSamples - mean * mean;
  CHECK(mean == Approx(0.1).epsilon(0.02));
  CHECK(mean * mean / (2 * variance) == Approx(spread_dof(kRatios)).epsilon(0.24));
}

TEST_CASE("single ratios that lie further out than normal variables are noise", "[statistical]") {
  // 4000 times 200 ratios by the law that single_dof names, tested together at 0.01 / 3: 13 alarms
  // in the mean, more than 27 with probability 3e-4. By spread_dof there are 226.
  std::mt19937_64 random(1);
  std::student_t_distribution<double> student(kTailDof);
  constexpr std::size_t kRatios = 200;
  int alarms = 0;
  for (int k = 0; k < 4000; ++k) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < kRatios; ++i) ratios.push_back(std::exp(0.08 * student(random)));
    TimeChange largest;
    largest.ratio = *std::max_element(ratios.begin(), ratios.end());
    largest.p = 0;
    decide(largest, 0, 0.01 / 3 / kRatios, spread_of(ratios), single_dof(kRatios));
    alarms += largest.change == Change::worse;
  }
  CHECK(alarms <= 27);
}

TEST_CASE("what got faster is told and is no regression", "[unit]") {
  const Comparison c = compared(timed(1, 1.4), timed(2));
  CHECK(c.study.change == Change::better);
  CHECK_FALSE(c.regression());
  CHECK(compared(timed(2), timed(1, 1.4), {.threshold = 0.5}).study.change == Change::none);
}

TEST_CASE("errors are compared by their intervals, those of one point set up to rounding",
          "[unit]") {
  const Json base = timed(1);
  Json now = timed(2);
  const std::size_t r = row_with_interval(now["cells"][0]);
  Json& row = row_of(now, 0, r);
  const double rmse = row["rmse"];
  const auto scale = [&](double factor) {
    row["rmse"] = rmse * factor;
    row["rmse_interval"] = {rmse * factor * 0.8, rmse * factor * 1.25};
    return compared(base, now).cells[0].rows[r].error;
  };
  CHECK(scale(1.05).change == Change::none);
  CHECK_FALSE(scale(1.05).suspect);
  CHECK(scale(1.7).suspect);
  CHECK(scale(1.7).change == Change::none);
  CHECK(scale(5).change == Change::worse);
  CHECK(compared(base, now).regression());
  CHECK(scale(0.2).change == Change::better);
  CHECK_FALSE(compared(base, now).regression());
  row["rmse"] = nullptr;
  row["error_reason"] = "none was found";
  CHECK_THAT(compared(base, now).cells[0].rows[r].error.reason, Contains("none was found"));
  CHECK(compared(base, now).regression());
  // Deterministic points.
  Json other = timed(2);
  const std::size_t d = deterministic_cell(other);
  other["cells"][d]["rounding_floor"] = 1e-12;
  Json& exact = row_of(other, d, 4);
  const double error = exact["rmse"];
  exact["rmse"] = error + 5e-13;
  CHECK(compared(base, other).cells[d].rows[4].error.change == Change::none);
  exact["rmse"] = error + 1e-9;
  CHECK(compared(base, other).cells[d].rows[4].error.change == Change::worse);
}

TEST_CASE("cells and rows that vanish or fail are regressions, new ones are listed", "[unit]") {
  const Json base = timed(1);
  Json fewer = timed(2);
  fewer["cells"].erase(1);
  CHECK(compared(base, fewer).cells[1].state == CellState::vanished);
  CHECK(compared(base, fewer).regression());
  const Comparison more = compared(fewer, base);
  CHECK(more.cells.back().state == CellState::added);
  CHECK_FALSE(more.regression());

  Json failed = timed(2);
  failed["cells"][1]["status"] = "failed";
  failed["cells"][1]["reason"] = "does not compile:\nline 3";
  failed["cells"][1]["precision"] = nullptr;  // as of a cell that was never planned
  failed["cells"][1]["rows"] = Json::array();
  const Comparison c = compared(base, failed);
  CHECK(c.cells.size() == base["cells"].size());
  CHECK(c.cells[1].state == CellState::failed);
  CHECK(c.cells[1].reason == "failed: does not compile:");
  CHECK(c.regression());
  CHECK(compared(failed, failed).cells[1].state == CellState::idle);
  CHECK_FALSE(compared(failed, failed).regression());

  Json shorter = timed(2);
  shorter["cells"][0]["rows"].erase(2);
  CHECK(compared(base, shorter).regression());
  CHECK_FALSE(compared(base, shorter).cells[0].rows[2].vanished.empty());

  // What a stop rule did not go on to has not vanished; what it passed by has.
  Json stopped = timed(2);
  Json& cell = stopped["cells"][0];
  while (cell["rows"].size() > 3) cell["rows"].erase(cell["rows"].size() - 1);
  cell["stopped"]["at_n"] = cell["rows"][2]["n"];
  CHECK(compared(base, stopped).regression());  // it had none
  cell["stopped"]["by"] = "until";
  CHECK_FALSE(compared(base, stopped).regression());
  CHECK_THAT(compared(base, stopped).cells[0].rows[3].time.reason, Contains("not run: "));
  cell["rows"].erase(1);
  CHECK(compared(base, stopped).regression());
}

TEST_CASE(
    "other devices, drivers and seeds are told; times of other devices are not compared unless "
    "asked",
    "[unit]") {
  const Json base = timed(1);
  Json now = timed(2, 2);
  now["context"]["device"]["driver"] = "4.0";
  now["context"]["seed"] = 7;
  const Comparison driver = compared(base, now);
  CHECK(driver.study.change == Change::worse);
  CHECK_THAT(compare_table(driver), Contains("driver: 4.0") && Contains("seed: 7, was 1"));
  now["context"]["device"]["name"] = "another";
  const Comparison device = compared(base, now);
  CHECK(device.study.change == Change::unknown);
  CHECK_FALSE(device.regression());
  CHECK_THAT(compare_table(device), Contains("times are not compared"));
  CHECK(compared(base, now, {.across_devices = true}).study.change == Change::worse);
  // Where one of them is twice as slow, its calibration is too.
  for (Json& cell : now["cells"])
    for (Json& row : cell["rows"])
      for (Json& t : row["calibration_s"]) t = 2 * t.get<double>();
  CHECK(compared(base, now, {.across_devices = true}).study.change == Change::worse);
  Json other = timed(2, 2);
  for (Json& cell : other["cells"]) cell["replicates"] = 7;
  CHECK_THAT(compared(base, other).cells[0].rows[0].time.reason, Contains("replicates: 7, were "));
  // A few launches are not those of a usual run; an older file has the usual.
  Json once = timed(2), usual = timed(3);
  for (Json& cell : once["cells"]) cell["launches"] = 1;
  for (Json& cell : usual["cells"]) cell["launches"] = nullptr;
  for (const Json& file : {base, usual}) {
    CHECK(compared(file, once).cells[0].rows[0].time.reason == "launches: 1, were as usual");
    CHECK(compared(once, file).cells[0].rows[0].time.reason == "launches: as usual, were 1");
  }
  CHECK_THAT(compared(base, usual).cells[0].rows[0].time.reason, !Contains("launches:"));
  CHECK_THAT(compared(once, once).cells[0].rows[0].time.reason, !Contains("launches:"));
  // Rows of several runs per launch are not timed against files that do not know of such.
  Json several = timed(2);
  several["cells"][0]["rows"][0]["runs_per_launch"] = 3;
  several["cells"][0]["rows"][1]["runs_per_launch"] = 1;
  const Comparison runs = compared(base, several);
  CHECK_THAT(runs.cells[0].rows[0].time.reason, Contains("several on the other"));
  CHECK_THAT(runs.cells[0].rows[1].time.reason, !Contains("several on the other"));
}

TEST_CASE("the table, the Markdown and the JSON say what changed", "[unit]") {
  Json now = timed(2);
  for (Json& r : now["cells"][1]["rows"])
    for (Json& t : r["kernel_times_s"]) t = 2 * t.get<double>();
  const Comparison c = compared(timed(1), now);
  const std::string table = compare_table(c), markdown = compare_markdown(c);
  CHECK_THAT(table, Contains("SLOWER") && Contains("REGRESSION: 1 of 5 cells"));
  CHECK_THAT(markdown, Catch::StartsWith("**koksma compare: REGRESSION: 1 of 5 cells**") &&
                           Contains("| SLOWER") && Contains("4 cells without change"));
  const Json json = compare_json(c);  // checks the schema
  CHECK(json["regression"] == true);
  CHECK(json["cells"][1]["regression"] == true);
  CHECK(json["cells"][1]["time"]["ratio"].get<double>() == Approx(2).epsilon(0.1));
  CHECK(json["cells"][0]["regression"] == false);
}

TEST_CASE("the command tells regressions by its exit status and refuses what are no results",
          "[unit]") {
  const test::TemporaryFolder folder;
  const std::string base = folder.write("base.json", dumped(timed(1))),
                    same = folder.write("same.json", dumped(timed(2))),
                    slow = folder.write("slow.json", dumped(timed(3, 1.5)));
  CHECK(run_command("compare " + base + " " + same).status == 0);
  CHECK(run_command("compare " + base + " " + slow).status == 1);
  CHECK(run_command("compare " + base + " " + slow + " --threshold 80").status == 0);
  const auto markdown = run_command("compare " + base + " " + slow + " --markdown");
  CHECK_THAT(markdown.output, Catch::StartsWith("**koksma compare: REGRESSION"));
  const auto both =
      run_command("compare " + base + " " + slow + " --json " + folder.path("c.json"));
  CHECK_THAT(both.output, Contains("REGRESSION"));
  CHECK(parse_json(read_text_file(folder.path("c.json")), "c.json")["regression"] == true);

  const auto refused = [&](const std::string& file, const char* why) {
    const auto result = run_command("compare " + base + " " + file);
    INFO(result.output);
    CHECK(result.status == 2);
    CHECK_THAT(result.output, Contains(why) && Contains(file));
  };
  const std::string text = dumped(timed(2));
  refused(folder.write("cut.json", text.substr(0, text.size() / 2)), "malformed JSON");
  refused(folder.write("study.json", R"({"n": "2^8", "cells": []})"), "no results file");
  Json old = timed(2);
  old["schema_version"] = 1;
  refused(folder.write("old.json", dumped(old)), "schema_version 1");
  Json wrong = timed(2);
  wrong["cells"][0]["rows"][0]["kernel_times_s"] = "fast";
  refused(folder.write("wrong.json", dumped(wrong)), "kernel_times_s");
  refused(folder.path("nowhere.json"), "cannot be read");
}
