// Where the rows of a cell end: rules by hand, sizes of every sampler, and --until and
// --time-budget through the command.
#include "estimate/stopping.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "catalog/sizes.hpp"
#include "error/error.hpp"
#include "journal/journal.hpp"
#include "report/results.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

const std::string kCell = "--scene linear-prod:d=2 --replicates 4 ";

test::RunResult run_cell(const test::TemporaryFolder& folder, const std::string& arguments) {
  test::RunResult result = test::run_study(folder, arguments);
  INFO(result.command.output);
  REQUIRE(result.command.status == 0);
  return result;
}

double relative_error(const Json& cell, const Json& row) {
  return row["rmse"].get<double>() / cell["efficiency"]["relative_to"].get<double>();
}

// Estimate and error of every row, by N.
Json numbers_of(const Json& cell) {
  Json numbers = Json::object();
  for (const Json& row : cell["rows"])
    numbers[std::to_string(row["n"].get<std::uint64_t>())] = {row["estimate"], row["rmse"]};
  return numbers;
}

std::string refusal_of_study(const Json& study) {
  try {
    study_from(test::catalog(), study, "s.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Json study_with(const Json& keys) {
  Json study = {{"n", "2^5..2^6"},
                {"cells", {{{"scenes", {"linear-prod:d=2"}}, {"samplers", {"sobol-owen"}}}}}};
  study.update(keys);
  return study;
}

}  // namespace

TEST_CASE("a row costs its launches: to 20 ms, three at least, five at most", "[unit]") {
  CHECK(row_seconds(1) == 1);
  CHECK(row_seconds(0.015) == Approx(0.045));
  CHECK(row_seconds(0.001) == Approx(0.005));
  // And 2 ms where launches make several runs.
  CHECK(row_seconds(1e-5) == Approx(5 * 1e-5 + 10 * kSecondsOfRuns));
  // Of fewer launches, none makes several.
  CHECK(row_seconds(0.015, 1) == Approx(0.015));
  CHECK(row_seconds(1e-5, 4) == Approx(4 * 1e-5));
}

TEST_CASE("the error reached ends a cell first, then its sizes, then its budget", "[unit]") {
  const std::vector<Timing> launches{{64, 1}, {128, 2}};
  StopFacts facts;
  facts.rule.until = 1e-3;
  facts.rule.time_budget = 7;
  facts.n = 128;
  facts.next = 256;
  facts.reached = 2e-3;
  facts.spent = 3;
  facts.launches = launches;
  CHECK_FALSE(why_stop(facts));  // 3 s and the 4 s of N = 256 are the budget
  facts.spent = 3.01;
  const Stopped budget = *why_stop(facts);
  CHECK(budget.by == "time-budget");
  CHECK(budget.at_n == 128);
  CHECK(budget.next_n == 256U);
  CHECK(*budget.predicted_s == Approx(4));
  const std::vector<Timing> short_launches{{64, 0.001}, {128, 0.002}};
  facts.launches = short_launches;
  facts.spent = 6.99;
  CHECK(why_stop(facts)->predicted_s == Approx(5 * 0.004));
  facts.most_launches = 2;
  CHECK_FALSE(why_stop(facts));
  facts.launches = launches;
  facts.spent = 3.01;
  facts.next.reset();
  CHECK(why_stop(facts)->by == "beyond-n");
  facts.sampler_ends = true;
  CHECK(why_stop(facts)->by == "sampler");
  facts.reached = 1e-3;
  CHECK(why_stop(facts)->by == "until");
  facts.reached.reset();
  facts.rule = {};
  CHECK(why_stop(facts)->by == "study");
  CHECK_FALSE(why_stop(facts)->reason.empty());
}

TEST_CASE("the error reached is relative to |I|, absolute where I = 0, none where unresolved",
          "[unit]") {
  Row row;
  row.estimates = {-3.9, -4.1};
  row.errors = summarise_errors(row.estimates, -4.0);
  CHECK(*reached_error(row, -4.0, std::nullopt) == Approx(0.025));
  // Against a reference; below 3 of its errors; the replicates about their own mean.
  CHECK(*reached_error(row, std::nullopt, Reference{-4, 0.01, ""}) == Approx(0.025));
  CHECK_FALSE(reached_error(row, std::nullopt, Reference{-4, 0.05, ""}));
  CHECK(*reached_error(row, std::nullopt, std::nullopt) == Approx(std::sqrt(0.02) / 4));
  row.errors = summarise_errors(std::vector<double>{0.1, -0.1}, 0.0);
  CHECK(*reached_error(row, 0.0, std::nullopt) == Approx(0.1));
  row.unresolved = "test";
  CHECK_FALSE(reached_error(row, 0.0, std::nullopt));
  row = {};
  CHECK_FALSE(reached_error(row, -4.0, std::nullopt));
}

TEST_CASE("beyond the study every sampler goes on to sizes that it has, at least doubled",
          "[unit]") {
  for (const Sampler& sampler : test::catalog().samplers) {
    Cell cell;
    cell.scene.dim = test::usual_dim(sampler);
    cell.n = {test::admitted_size(sampler, cell.scene.dim, 64)};
    INFO(sampler.name << " in " << cell.scene.dim << " dimensions");
    CHECK_FALSE(next_size(sampler, cell, cell.n.back()));
    cell.stop.time_budget = 1;
    std::uint64_t n = cell.n.back();
    for (auto next = next_size(sampler, cell, n); next; next = next_size(sampler, cell, n)) {
      REQUIRE(*next >= 2 * n);
      REQUIRE(*next <= std::uint64_t{1} << sampler.max_log2_n);
      REQUIRE(admits(sampler, cell.scene.dim, *next));
      n = *next;
    }
    CHECK(n > std::uint64_t{1} << (sampler.max_log2_n / 2));
    cell.stop = {};
    cell.stop.until = 1e-3;
    CHECK(largest_size(sampler, cell) ==
          std::min(64 * cell.n.back(), std::uint64_t{1} << sampler.max_log2_n));
    cell.stop.beyond_n = 2 * cell.n.back();
    CHECK(largest_size(sampler, cell) ==
          std::min(2 * cell.n.back(), std::uint64_t{1} << sampler.max_log2_n));
  }
}

TEST_CASE("sizes that were asked for come first, as they are", "[unit]") {
  const Sampler random = test::catalog().sampler("random", "test");
  Cell cell;
  cell.n = {100, 130, 1000};
  cell.stop.until = 1e-3;
  CHECK(next_size(random, cell, 100) == 130U);
  CHECK(next_size(random, cell, 130) == 1000U);
  CHECK(next_size(random, cell, 1000) == 2000U);
  CHECK_FALSE(next_size(random, cell, 64000));
}

TEST_CASE("stop rules are read from the block, else the study, and flags replace them", "[unit]") {
  Json study = study_with({{"until", 1e-3}, {"time_budget", 2}, {"beyond_n", "2^10"}});
  study["cells"][0]["until"] = 1e-4;
  const StopRule rule = study_from(test::catalog(), study, "s.json").cells[0].stop;
  CHECK(rule.until == 1e-4);
  CHECK(rule.time_budget == 2.0);
  CHECK(rule.beyond_n == 1024U);
  StudyFlags flags;
  flags.until = 1e-5;
  flags.time_budget = 3;
  const Study flagged = study_from(test::catalog(), study, "s.json", flags);
  CHECK(flagged.cells[0].stop.until == 1e-5);
  CHECK(flagged.cells[0].stop.time_budget == 3.0);
  CHECK(flagged.verbatim["until"] == 1e-5);
  CHECK_FALSE(flagged.verbatim["cells"][0].contains("until"));
  CHECK_FALSE(
      study_from(test::catalog(), study_with(Json::object()), "s.json").cells[0].stop.any());
}

TEST_CASE("a stop rule that can not be meant is told with its place", "[unit]") {
  CHECK_THAT(refusal_of_study(study_with({{"beyond_n", "2^10"}})),
             Contains("s.json, at '/beyond_n'") && Contains("time_budget or until"));
  CHECK_THAT(refusal_of_study(study_with({{"until", 1e-3}, {"beyond_n", "2^5"}})),
             Contains("below the largest N, 64"));
  CHECK_THAT(refusal_of_study(study_with({{"until", 1e-3}, {"beyond_n", "2^8..2^9"}})),
             Contains("no single sample count"));
  CHECK_THAT(refusal_of_study(study_with({{"until", 0}})), Contains("/until"));
  CHECK_THAT(refusal_of_study(study_with({{"time_budget", -1}})), Contains("/time_budget"));
  for (const char* flag : {"--until 0", "--until x", "--time-budget -1"}) {
    const auto run = test::run_command("run " + kCell + "--sampler random " + flag);
    CHECK(run.status == 2);
    CHECK_THAT(run.output, Contains(std::string(flag).substr(0, std::string(flag).find(' '))) &&
                               Contains("allowed is a finite number above 0"));
  }
}

TEST_CASE("launches are read from the block, else the study, and the flag replaces them",
          "[unit]") {
  Json study = study_with({{"launches", 2}});
  const auto launches = [&](const StudyFlags& flags = {}) {
    return study_from(test::catalog(), study, "s.json", flags).cells[0].launches;
  };
  CHECK(launches() == 2U);
  study["cells"][0]["launches"] = 3;
  CHECK(launches() == 3U);
  StudyFlags flags;
  flags.launches = 4;
  CHECK(launches(flags) == 4U);
  study = study_with(Json::object());
  CHECK_FALSE(launches());
  for (const Json& wrong : {Json(0), Json(17), Json(1.5)})
    CHECK_THAT(refusal_of_study(study_with({{"launches", wrong}})), Contains("/launches"));
  for (const char* wrong : {"0", "17", "many"}) {
    const auto run = test::run_command("run " + kCell + "--sampler random --launches " + wrong);
    CHECK(run.status == 2);
    CHECK_THAT(run.output, Contains("--launches"));
  }
}

TEST_CASE("rows are launched as often as --launches says, with the same estimates",
          "[device][timing]") {
  const test::TemporaryFolder folder;
  const std::string flags = kCell + "--sampler sobol-owen --n 2^5..2^6 ";
  const Json usual = run_cell(folder, flags).results["cells"][0]["rows"];
  for (const std::string more : {"", "--time-budget 1e-6 "})
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
      const Json rows = run_cell(folder, flags + more + fmt::format("--launches {}", count))
                            .results["cells"][0]["rows"];
      INFO(more << count);
      REQUIRE(rows.size() == (more.empty() ? 2 : 1));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        CHECK(rows[i]["kernel_s"]["count"] == count);
        CHECK(rows[i]["wall_s"]["count"] == count);
        CHECK(rows[i]["kernel_times_s"].size() == count);
        CHECK(rows[i]["estimate"] == usual[i]["estimate"]);
        CHECK(rows[i]["rmse"] == usual[i]["rmse"]);
        CHECK(usual[i]["kernel_s"]["count"] > 2);
      }
    }
}

TEST_CASE("--until goes on beyond the study by doubling, and stops at the first N that is there",
          "[device]") {
  const test::TemporaryFolder folder;
  const std::string cell = kCell + "--sampler sobol-owen ";
  const Json until = run_cell(folder, cell + "--n 2^5..2^6 --until 1e-4").results["cells"][0];
  CHECK(until["stopped"]["by"] == "until");
  REQUIRE(until["rows"].size() > 2);
  std::uint64_t n = 32;
  for (std::size_t k = 0; k < until["rows"].size(); ++k, n *= 2) {
    const Json& row = until["rows"][k];
    CHECK(row["n"] == n);
    CHECK((relative_error(until, row) <= 1e-4) == (k + 1 == until["rows"].size()));
  }
  CHECK(until["stopped"]["at_n"] == n / 2);
  CHECK(until["stopped"]["reached"].get<double>() ==
        Approx(relative_error(until, until["rows"].back())));
  // The same numbers as of a study that has these sizes.
  const Json plain =
      run_cell(folder, fmt::format("{} --n 2^5..2^{}", cell, std::lround(std::log2(n / 2))))
          .results["cells"][0];
  CHECK(plain["stopped"]["by"] == "study");
  CHECK(numbers_of(plain) == numbers_of(until));
  // Within the study's sizes the rest is not run.
  const Json early = run_cell(folder, cell + "--n 2^5..2^18 --until 1e-4 --quiet").results;
  CHECK(numbers_of(early["cells"][0]) == numbers_of(until));
}

TEST_CASE("--until that is never there ends at beyond_n, or with the sampler, and nothing failed",
          "[device]") {
  const test::TemporaryFolder folder;
  std::string points;
  for (int i = 0; i < 100; ++i)
    points += fmt::format("{:.4f},{:.4f}\n", i / 100.0, i * 7 % 100 / 100.0);
  const std::string file = folder.write("points.csv", points);
  Json study = study_with({{"until", 1e-12}, {"beyond_n", "2^9"}, {"replicates", 4}});
  study["cells"][0]["samplers"] = {"sobol-owen", "file:path=" + file};
  const test::RunResult run = run_cell(folder, folder.write("s.json", study.dump()));
  const Json& owen = run.results["cells"][0];
  CHECK(owen["status"] == "ok");
  CHECK(owen["stopped"]["by"] == "beyond-n");
  CHECK(owen["stopped"]["at_n"] == 512);
  CHECK(owen["rows"].size() == 5);
  CHECK_THAT(owen["stopped"]["reason"].get<std::string>(), Contains("1e-12 is not reached"));
  const Json& fixed = run.results["cells"][1];
  CHECK(fixed["status"] == "ok");
  CHECK(fixed["stopped"]["by"] == "sampler");
  CHECK(fixed["stopped"]["at_n"] == 64);
  CHECK_THAT(fixed["stopped"]["reason"].get<std::string>(), Contains("100"));
  CHECK_THAT(run.command.output, Contains("stopped: beyond-n") && Contains("stopped: sampler"));
}

TEST_CASE("--time-budget runs rows until the next is predicted to exceed it", "[device][timing]") {
  const test::TemporaryFolder folder;
  const std::string cell = kCell + "--sampler random --n 2^5..2^8 ";
  // Whatever the machine: the first row is run, and no other in a microsecond.
  const Json short_run = run_cell(folder, cell + "--time-budget 1e-6").results["cells"][0];
  CHECK(short_run["rows"].size() == 1);
  CHECK(short_run["stopped"]["by"] == "time-budget");
  CHECK(short_run["stopped"]["next_n"] == 64);
  CHECK(short_run["status"] == "ok");
  const Json long_run = run_cell(folder, cell + "--time-budget 0.5").results["cells"][0];
  const Json& stopped = long_run["stopped"];
  CHECK(stopped["by"] == "time-budget");
  CHECK(stopped["at_n"].get<std::uint64_t>() > 256);
  CHECK(stopped["next_n"].get<std::uint64_t>() == 2 * stopped["at_n"].get<std::uint64_t>());
  CHECK(stopped["spent_s"].get<double>() + stopped["predicted_s"].get<double>() > 0.5);
  CHECK(long_run["rows"].back()["n"] == stopped["at_n"]);
}

TEST_CASE("--resume takes over a cell of the same stop rule, and of no other", "[device]") {
  const test::TemporaryFolder folder;
  const std::string flags = kCell + "--sampler sobol-owen --n 2^5..2^6 ";
  const Json original = run_cell(folder, flags + "--until 1e-2 --quiet").results;
  StudyFlags parsed;
  parsed.scenes = {"linear-prod:d=2"};
  parsed.samplers = {"sobol-owen"};
  parsed.n = "2^5..2^6";
  parsed.replicates = 4;
  parsed.until = 1e-2;
  const Study study = read_study(test::catalog(), "", parsed);
  const auto resumed = [&](const std::string& rule) {
    Json marked = original["cells"][0];
    marked["build_s"] = 12345;  // as no measurement would have
    Journal(folder.path("r.json"), resume_context(original["context"]), false)
        .append(cell_identity(study.cells[0]), marked);
    return run_cell(folder, flags + rule + " --quiet --resume").results["cells"][0]["build_s"] ==
           12345;
  };
  CHECK(resumed("--until 1e-2"));
  CHECK_FALSE(resumed("--until 1e-3"));
  CHECK_FALSE(resumed(""));
  CHECK_FALSE(resumed("--until 1e-2 --time-budget 60"));
}
