// `koksma run` from end to end: what the results say, what happens to cells that cannot run, and
// that nothing measured is lost.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <functional>

#include "catalog/embedded.hpp"
#include "device/calibration.hpp"
#include "error/error.hpp"
#include "journal/cell_json.hpp"
#include "journal/journal.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;
using koksma::test::CommandResult;
using koksma::test::run_command;
using koksma::test::run_study;
using koksma::test::RunResult;

namespace {

namespace fs = std::filesystem;

// A user's pair of files: an embedded integrand under a new name, its code changed.
std::string own_integrand(const test::TemporaryFolder& folder, const std::string& name,
                          const std::string& from, const std::string& to) {
  const Integrand& model = test::catalog().integrand("linear-prod", "test");
  Json entry = parse_json(
      embedded_text(model.code.path.substr(0, model.code.path.size() - 3) + ".json"), "test");
  entry["name"] = name;
  std::string code = model.code.text;
  const std::size_t at = code.find(from);
  REQUIRE(at != std::string::npos);
  folder.write(name + ".cl", code.replace(at, from.size(), to));
  return folder.write(name + ".json", entry.dump());
}

// The line number, from 1, of the first line that holds `part`.
std::ptrdiff_t line_with(const std::string& text, const std::string& part) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(part)),
                        '\n');
}

// Everything but times, which differ from run to run.
Json errors_of(const Json& results) {
  Json errors = Json::array();
  for (const Json& cell : results["cells"])
    for (const Json& row : cell["rows"]) {
      Json kept;
      for (const char* key : {"n", "estimate", "standard_error", "rmse", "rmse_interval",
                              "median_abs_error", "bias", "sd", "nonfinite"})
        kept[key] = row[key];
      errors.push_back(kept);
    }
  return errors;
}

}  // namespace

TEST_CASE("a cell that fails is a row, status 1, and the other cells' results stay", "[device]") {
  const test::TemporaryFolder folder;
  // Only the kernel that integrates fails, which no check of a user's files builds. A Latin-1 byte
  // beside the mistake: what compilers quote need not be UTF-8.
  const std::string json =
      own_integrand(folder, "my-broken", "return product;",
                    "\n#ifdef KOKSMA_MOMENTS\nprodct; // \xE9\n#endif\n  return product;");
  const std::string code = folder.path("my-broken.cl");
  const RunResult run =
      run_study(folder, "--integrand " + json +
                            " --scene my-broken:d=2 --scene linear-prod:d=2 --sampler sobol "
                            "--sampler random --n 2^6 --replicates 2");
  INFO(run.command.output);
  CHECK(run.command.status == 1);
  const std::string place = fmt::format("{}:{}:", code, line_with(read_text_file(code), "prodct"));
  CHECK_THAT(run.command.output,
             Contains("does not compile") && Contains(place) && Contains("prodct"));
  REQUIRE(run.results["cells"].size() == 4);
  for (const Json& cell : run.results["cells"]) {
    const bool broken = cell["scene"]["integrand"] == "my-broken";
    CHECK(cell["status"] == (broken ? "failed" : "ok"));
    CHECK(cell["rows"].size() == (broken ? 0U : 1U));
    if (broken) CHECK_THAT(cell["reason"].get<std::string>(), Contains(place));
  }
  // The table keeps to a line per cell.
  const std::string table = results_table(run.results);
  CHECK_THAT(table, Contains("failed: the kernel of my-broken") && !Contains("prodct"));
  // A finished results file leaves no journal and no temporary file.
  CHECK_FALSE(fs::exists(folder.path("r.json.journal.jsonl")));
  CHECK_FALSE(fs::exists(folder.path("r.json.new")));
}

TEST_CASE("a user's integrand runs, lists and is explained without a rebuild", "[device]") {
  const test::TemporaryFolder folder;
  const std::string json =
      own_integrand(folder, "my-own", "R(1.0) + (c[j]", "(R(1.0) + R(0.0)) + (c[j]");
  const RunResult run = run_study(folder, "--integrand " + json +
                                              " --scene my-own:d=2 --scene linear-prod:d=2 "
                                              "--sampler sobol-owen --n 2^6 --replicates 4");
  INFO(run.command.output);
  CHECK(run.command.status == 0);
  REQUIRE(run.results["cells"].size() == 2);
  CHECK(run.results["cells"][0]["status"] == "ok");
  // The model's own code under another name: the same bits.
  CHECK(run.results["cells"][0]["rows"][0]["estimate"] ==
        run.results["cells"][1]["rows"][0]["estimate"]);
  CHECK(run.results["cells"][0]["scene"]["exact"] == run.results["cells"][1]["scene"]["exact"]);
  CHECK_THAT(run_command("list integrands --integrand " + json).output, Contains("my-own"));
  CHECK_THAT(
      run_command("explain --scene my-own:d=2 --sampler sobol --n 2^6 --integrand " + json).output,
      Contains("#line 1 \"" + folder.path("my-own.cl") + "\""));
}

TEST_CASE("two runs give identical errors, another seed gives others", "[device]") {
  const test::TemporaryFolder folder;
  const std::string cells =
      "--scene linear-prod:d=3 --scene genz-discontinuous:d=2 --sampler sobol-owen --sampler "
      "random --sampler lattice-shift --n 2^6..2^8 --replicates 4 --quiet";
  const Json first = errors_of(run_study(folder, cells).results);
  CHECK(first.size() == 18);
  CHECK(first == errors_of(run_study(folder, cells).results));
  CHECK(first == errors_of(run_study(folder, cells + " --seed 1").results));
  CHECK(first != errors_of(run_study(folder, cells + " --seed 2").results));
}

TEST_CASE("the results say what was asked and how it was built", "[device]") {
  const test::TemporaryFolder folder;
  const RunResult run =
      run_study(folder, test::kCheap + "--seed 5 --precision fp32 --sum kahan --quiet");
  CHECK(run.command.output.empty());
  CHECK(run.results["schema_version"] == kResultsSchemaVersion);
  CHECK(run.results["context"]["seed"] == 5);
  CHECK(run.results["context"]["calibration"] == Calibration::identity(test::device().facts()));
  CHECK_THAT(run.results["context"]["command"].get<std::string>(),
             Contains("run " + test::kCheap.substr(0, test::kCheap.size() - 1)));
  CHECK(run.results["context"]["study"]["cells"][0]["samplers"] == Json({"sobol-owen"}));
  const Json& cell = run.results["cells"][0];
  CHECK(cell["scene"]["text"] == "linear-prod:d=2");
  CHECK(cell["scene"]["parameters"].size() ==
        test::catalog().integrand("linear-prod", "test").parameters.size());
  CHECK(cell["precision"] == "fp32");
  CHECK(cell["sum"] == "kahan");
  CHECK(cell["replicates"] == 4);
  CHECK(cell["estimator"] == "rqmc");
  CHECK(cell["plan"]["dimensions_drawn"] == 2);
  CHECK(cell["plan"]["coordinate_bits"] == 23);
  // Broken by one key, the file is refused.
  Json broken = run.results;
  broken["cells"][0]["rows"][0]["rmsee"] = 0;
  CHECK_THROWS_WITH(
      check_schema(broken, "results/results.schema.json", "r.json"),
      Contains("r.json, at '/cells/0/rows/0/rmsee'") && Contains("did you mean 'rmse'?"));
  broken = run.results;
  broken["cells"][0]["rows"][0]["kernel_s"]["min"] = "fast";
  CHECK_THROWS_WITH(check_schema(broken, "results/results.schema.json", "r.json"),
                    Contains("/cells/0/rows/0/kernel_s/min"));
}

TEST_CASE("non-finite samples are counted in every row, and never written as NaN", "[device]") {
  const test::TemporaryFolder folder;
  // Sobol' points begin with x = 0, whose normal quantile is -infinity.
  const RunResult run = run_study(
      folder,
      "--scene keister:d=2 --sampler sobol --sampler sobol-owen --n 2^5..2^8 --replicates 4");
  CHECK(run.command.status == 0);
  for (const Json& row : run.results["cells"][0]["rows"]) {
    INFO(row["n"]);
    CHECK(row["nonfinite"] == 1);
    for (const char* key : {"estimate", "rmse", "median_abs_error", "bias"})
      CHECK(row[key].is_null());
    CHECK_FALSE(row["interval_reason"].get<std::string>().empty());
  }
  CHECK(run.results["cells"][0]["rows"].size() == 4);
  CHECK(run.results["cells"][0]["convergence"]["rows_excluded"].size() == 4);
  for (const Json& row : run.results["cells"][1]["rows"])
    CHECK((row["nonfinite"] == 0 && row["rmse"].is_number()));
  // JSON has no NaN: the strict parser has read the file already; this is for the spelling in
  // strings.
  const std::string text = read_text_file(folder.path("r.json"));
  CHECK_THAT(text, !Contains(": nan", Catch::CaseSensitive::No) &&
                       !Contains(": inf", Catch::CaseSensitive::No) &&
                       !Contains(": \"nan\"", Catch::CaseSensitive::No));
  CHECK_THAT(run.command.output, Contains("non-finite:1"));
}

TEST_CASE("fp64 on a device without it is an unsupported row, not an error", "[unit]") {
  DeviceFacts facts;
  facts.name = "a small GPU";
  facts.is_cpu = false;
  facts.fp64 = false;
  facts.max_work_group_size = 64;
  Cell cell = test::cell("linear-prod:d=2", "sobol", 64);
  cell.precision = Precision::fp64;
  CHECK_THROWS_AS(make_plan(test::catalog(), cell, facts), UnsupportedError);
  CHECK_THROWS_WITH(make_plan(test::catalog(), cell, facts),
                    Contains("fp64") && Contains("a small GPU"));
  for (const SumAlgorithm& s : test::catalog().sums) {
    cell.precision = Precision::fp32;
    cell.sum = s.name;
    if (s.needs_fp64)
      CHECK_THROWS_WITH(make_plan(test::catalog(), cell, facts),
                        Contains("sum '" + s.name + "' needs fp64") && Contains("a small GPU"));
    else
      CHECK_NOTHROW(make_plan(test::catalog(), cell, facts));
  }
  // Unasked, precision and sum are what the device has.
  const Plan plan = make_plan(test::catalog(), test::cell("linear-prod:d=2", "sobol", 64), facts);
  CHECK(plan.precision == Precision::fp32);
  CHECK_FALSE(plan.sum->needs_fp64);

  CellResult result;
  result.cell = test::cell("linear-prod:d=2", "sobol", 64);
  result.cell.precision = Precision::fp64;
  result.status = CellStatus::unsupported;
  result.reason = "precision fp64 on a small GPU";
  const Json json = cell_to_json(test::catalog(), result, nullptr);
  CHECK(json["status"] == "unsupported");
  CHECK(json["precision"] == "fp64");
  CHECK(json["reason"] == result.reason);
}

TEST_CASE(
    "a sampler that would repeat points at this precision is an unsupported row, and the run goes "
    "on",
    "[device]") {
  const test::TemporaryFolder folder;
  const RunResult run = run_study(
      folder,
      folder.write(
          "s.json",
          R"({"precision": "fp32", "cells": [{"scenes": ["linear-prod:d=2"], "samplers": ["sobol"], "n": "2^24"},
                                                                      {"scenes": ["linear-prod:d=2"], "samplers": ["sobol"], "n": "2^6"}]})"));
  CHECK(run.command.status == 0);
  REQUIRE(run.results["cells"].size() == 2);
  CHECK(run.results["cells"][0]["status"] == "unsupported");
  CHECK_THAT(run.results["cells"][0]["reason"].get<std::string>(), Contains("would repeat points"));
  CHECK(run.results["cells"][1]["status"] == "ok");
}

TEST_CASE("--resume takes over the finished cells of a journal, and only those", "[device]") {
  const test::TemporaryFolder folder;
  const std::string study = folder.write(
      "s.json",
      R"({"seed": 3, "replicates": 2, "cells": [{"scenes": ["linear-prod:d=2"], "samplers": ["sobol-owen", "random"], "n": "2^6"}]})");
  const Json original = run_study(folder, study + " --quiet").results;
  const auto write_journal = [&](const Json& context) {
    const Study parsed = read_study(test::catalog(), study, {});
    // A mark that a fresh measurement would not have.
    Json marked = original["cells"][0];
    marked["build_s"] = 12345;
    Journal(folder.path("r.json"), context, false).append(cell_identity(parsed.cells[0]), marked);
  };
  const Json context = resume_context(original["context"]);
  write_journal(context);
  const RunResult resumed = run_study(folder, study + " --resume");
  CHECK_THAT(resumed.command.output, Contains("1 finished cells taken over"));
  CHECK(resumed.results["cells"][0]["build_s"] == 12345);
  CHECK(resumed.results["cells"][1]["build_s"] != 12345);
  CHECK(errors_of(resumed.results) == errors_of(original));
  CHECK_FALSE(fs::exists(folder.path("r.json.journal.jsonl")));
  // Not asked to resume, another seed, another program: measured anew.
  write_journal(context);
  CHECK(run_study(folder, study + " --quiet").results["cells"][0]["build_s"] != 12345);
  write_journal(context);
  CHECK(run_study(folder, study + " --quiet --resume --seed 4").results["cells"][0]["build_s"] !=
        12345);
  Json other = context;
  other["revision"] = "another";
  write_journal(other);
  CHECK(run_study(folder, study + " --quiet --resume").results["cells"][0]["build_s"] != 12345);
}

TEST_CASE("a killed run loses no finished cell, and an edited integrand is measured again",
          "[device]") {
  const test::TemporaryFolder folder;
  const std::string integrand =
      " --integrand " +
      own_integrand(folder, "my-own", "real product = R(1.0);", "real product = R(1.00);");
  // The second cell takes minutes; the run is killed as soon as the first is in the journal.
  const std::string both = folder.write(
      "both.json",
      R"({"replicates": 8, "cells": [{"scenes": ["my-own:d=2"], "samplers": ["sobol-owen"], "n": "2^6"},
                                                          {"scenes": ["linear-prod:d=100"], "samplers": ["random"], "n": "2^32"}]})");
  const std::string first = folder.write(
      "first.json",
      R"({"replicates": 8, "cells": [{"scenes": ["my-own:d=2"], "samplers": ["sobol-owen"], "n": "2^6"}]})");
  const std::string journal = folder.path("r.json.journal.jsonl");
  const std::string script = fmt::format(
      "{} run {} --quiet {} --out {} & pid=$!; i=0; while [ $i -lt 1200 ] && [ \"$(cat {} "
      "2>/dev/null | wc -l)\" -lt 2 ]; do sleep 0.1; i=$((i+1)); done; kill -9 $pid; wait $pid "
      "2>/dev/null; true",
      KOKSMA_COMMAND, both, integrand, folder.path("r.json"), journal);
  REQUIRE(std::system(("sh -c '" + script + "'").c_str()) == 0);
  CHECK_FALSE(fs::exists(folder.path("r.json")));
  const std::string kept = read_text_file(journal);
  REQUIRE(std::count(kept.begin(), kept.end(), '\n') == 2);
  const Json measured = Json::parse(kept.substr(kept.find('\n') + 1))["cell"];

  const RunResult resumed = run_study(folder, first + integrand + " --resume");
  CHECK_THAT(resumed.command.output, Contains("1 finished cells taken over"));
  CHECK(resumed.results["cells"][0]["rows"] == measured["rows"]);

  folder.write("r.json.journal.jsonl", kept);
  own_integrand(folder, "my-own", "real product = R(1.0);", "real product = R(2.0);");
  const RunResult edited = run_study(folder, first + integrand + " --resume");
  CHECK_THAT(edited.command.output, !Contains("taken over") && Contains("is kept as"));
  CHECK(read_text_file(journal + ".1") == kept);
  CHECK(edited.results["cells"][0]["rows"][0]["estimate"].get<double>() ==
        Approx(2 * measured["rows"][0]["estimate"].get<double>()));
}

TEST_CASE("output that is not to a terminal is plain lines, and quiet output is nothing",
          "[device]") {
  const test::TemporaryFolder folder;
  const RunResult run = run_study(folder, test::kCheap);
  CHECK(run.command.status == 0);
  CHECK(run.command.output.find('\x1b') == std::string::npos);
  CHECK(run.command.output.find('\r') == std::string::npos);
  CHECK_THAT(run.command.output, Contains("\n[1/1] linear-prod:d=2 with sobol-owen: RMSE ") &&
                                     Contains("results: " + folder.path("r.json")));
  CHECK_THAT(run.command.output,
             Contains("scene") && Contains("Gcoord/s") && Contains("±") && Contains("2^6"));
}
