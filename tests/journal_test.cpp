// What is on disk: the journal gives back what was finished and nothing else, files appear whole or
// not at all, and no number that JSON cannot hold gets into it.
#include "journal/journal.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>

#include "error/error.hpp"
#include "journal/cell_json.hpp"
#include "report/results.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;

const Json kContext = {{"device", "x"}, {"revision", "1"}};

Json identity(int k) {
  return cell_identity(test::cell("linear-prod:d=" + std::to_string(k), "random", 64));
}

std::size_t files_in(const test::TemporaryFolder& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder.path("")), fs::directory_iterator{}));
}

// A results file of one cell that was refused, as `koksma run` writes it.
Json results_of_a_refused_cell(CellStatus status, const std::string& reason) {
  CellResult result;
  result.cell = test::cell("linear-prod:d=2", "random", 64);
  result.status = status;
  result.reason = reason;
  result.verdict.verdict = "no-rate";
  DeviceFacts facts;
  Study study;
  study.verbatim = Json::object();
  return make_results(make_context(facts, study, "koksma run"),
                      Json::array({cell_to_json(test::catalog(), result, nullptr)}));
}

}  // namespace

TEST_CASE("a resumed journal of the same context gives back every finished cell", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  {
    Journal journal(out, kContext, false);
    CHECK(journal.path() == out + ".journal.jsonl");
    CHECK_FALSE(journal.finished(identity(1)));
    journal.append(identity(1), {{"value", 0.1}});
    journal.append(identity(2), {{"value", 2}});
    CHECK(journal.finished(identity(2))->at("value") == 2);
  }
  for (int again = 0; again < 2; ++again) {
    const Journal journal(out, kContext, true);
    CHECK(journal.taken_over() == 2);
    CHECK(journal.finished(identity(1)) == Json{{"value", 0.1}});
    CHECK(journal.finished(identity(2)) == Json{{"value", 2}});
    CHECK_FALSE(journal.finished(identity(3)));
  }
}

TEST_CASE("a cell that was withdrawn is not given back", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  {
    Journal journal(out, kContext, false);
    journal.append(identity(1), {{"value", 1}});
    journal.append(identity(2), {{"value", 2}});
    journal.withdraw(identity(1));
    CHECK_FALSE(journal.finished(identity(1)));
  }
  const Journal journal(out, kContext, true);
  CHECK(journal.taken_over() == 1);
  CHECK_FALSE(journal.finished(identity(1)));
  CHECK(journal.finished(identity(2)) == Json{{"value", 2}});
}

TEST_CASE("appended cells are on disk at once, after the cells taken over", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  { Journal(out, kContext, false).append(identity(1), {{"value", 1}}); }
  Journal journal(out, kContext, true);
  journal.append(identity(2), {{"value", 2}});
  // Not closed: this is what a kill leaves.
  const std::string kept = read_text_file(journal.path());
  CHECK(std::count(kept.begin(), kept.end(), '\n') == 3);
  CHECK_THAT(kept, Contains("{\"value\":1}") && Contains("{\"value\":2}"));
}

TEST_CASE("any change to a cell makes it another cell", "[unit]") {
  const Cell base = test::cell("linear-prod:d=3", "sobol-owen", 64, 8);
  std::set<std::string> seen{cell_identity(base).dump()};
  const auto differs = [&](const std::function<void(Cell&)>& change) {
    Cell other = base;
    change(other);
    return seen.insert(cell_identity(other).dump()).second;
  };
  CHECK(
      differs([](Cell& c) { c.scene = parse_scene(test::catalog(), "linear-prod:d=4", "test"); }));
  CHECK(differs([](Cell& c) {
    c.scene = parse_scene(test::catalog(), "linear-prod:d=3,scale=0.3", "test");
  }));
  CHECK(differs([](Cell& c) { c.sampler = "sobol-shift"; }));
  CHECK(differs([](Cell& c) { c.estimator = "qmc"; }));
  CHECK(differs([](Cell& c) { c.precision = Precision::fp32; }));
  CHECK(differs([](Cell& c) { c.sum = "kahan"; }));
  CHECK(differs([](Cell& c) { c.n = {64, 128}; }));
  CHECK(differs([](Cell& c) { c.replicates = 9; }));
  CHECK(differs([](Cell& c) { c.seed = 2; }));
  CHECK(differs([](Cell& c) { c.stop.time_budget = 1; }));
  CHECK(differs([](Cell& c) { c.stop.time_budget = 2; }));
  CHECK(differs([](Cell& c) { c.stop.until = 1; }));
  CHECK(differs([](Cell& c) { c.stop.until = 2; }));
  CHECK(differs([](Cell& c) { c.stop.beyond_n = 128; }));
  CHECK(differs([](Cell& c) { c.launches = 1; }));
}

TEST_CASE(
    "a journal of another context, or of a run that is not resumed, is kept under another name",
    "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  { Journal(out, kContext, false).append(identity(1), {{"value", 1}}); }
  Json other = kContext;
  other["revision"] = "2";
  {
    const Journal journal(out, other, true);
    CHECK(journal.taken_over() == 0);
    CHECK_FALSE(journal.finished(identity(1)));
    CHECK(journal.set_aside() == out + ".journal.jsonl.1");
  }
  CHECK_THAT(read_text_file(out + ".journal.jsonl"), !Contains("value"));
  CHECK_THAT(read_text_file(out + ".journal.jsonl.1"), Contains("{\"value\":1}"));
  { Journal(out, kContext, false).append(identity(1), {{"value", 1}}); }
  CHECK_FALSE(Journal(out, kContext, false).finished(identity(1)));
  CHECK_THAT(read_text_file(out + ".journal.jsonl.2"), Contains("{\"value\":1}"));
}

TEST_CASE("cells taken over that nobody asked for stay in the journal", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  {
    Journal journal(out, kContext, false);
    journal.append(identity(1), {{"value", 1}});
    journal.append(identity(2), {{"value", 2}});
  }
  {
    Journal narrower(out, kContext, true);
    REQUIRE(narrower.finished(identity(1)));
    narrower.remove();
  }
  Journal all(out, kContext, true);
  REQUIRE(all.finished(identity(1)));
  REQUIRE(all.finished(identity(2)));
  all.remove();
  CHECK(files_in(folder) == 0);
}

TEST_CASE("two runs cannot write the same results", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  Journal first(out, kContext, false);
  first.append(identity(1), {{"value", 1}});
  CHECK_THROWS_WITH(Journal(out, kContext, false),
                    Contains("another run is writing these results"));
  CHECK_THAT(read_text_file(first.path()), Contains("{\"value\":1}"));
}

TEST_CASE("a last line that was cut off anywhere loses that cell alone", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("r.json");
  {
    Journal journal(out, kContext, false);
    journal.append(identity(1), {{"value", 1}});
    journal.append(identity(2), {{"value", 2}});
  }
  const std::string whole = read_text_file(out + ".journal.jsonl");
  const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t length = last; length + 1 < whole.size(); length += 7) {
    folder.write("r.json.journal.jsonl", whole.substr(0, length));
    INFO("cut at " << length << " of " << whole.size());
    {
      Journal journal(out, kContext, true);
      REQUIRE(journal.taken_over() == 1);
      REQUIRE(journal.finished(identity(1)));
      // The rest of the cut line does not spoil what is appended now.
      journal.append(identity(3), {{"value", 3}});
    }
    REQUIRE(Journal(out, kContext, true).taken_over() == 2);
  }
}

TEST_CASE("rubbish in a journal is passed over", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string header = Json{{"context", kContext}}.dump() + "\n";
  folder.write("r.json.journal.jsonl", std::string("\x00\xff{]\n", 5) + header +
                                           "5\n[]\nnull\n{\"identity\":1}\n{\"cell\":1}\n\n" +
                                           Json{{"identity", identity(1)}, {"cell", 7}}.dump() +
                                           "\n");
  const Journal journal(folder.path("r.json"), kContext, true);
  CHECK(journal.taken_over() == 1);
  CHECK(journal.finished(identity(1)) == Json(7));
}

TEST_CASE("a removed journal leaves nothing", "[unit]") {
  const test::TemporaryFolder folder;
  Journal journal(folder.path("r.json"), kContext, false);
  journal.append(identity(1), {{"value", 1}});
  journal.remove();
  CHECK(files_in(folder) == 0);
}

TEST_CASE("a journal that cannot be written is the user's mistake and names the path", "[unit]") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_AS(Journal(folder.path("none/r.json"), kContext, false), InputError);
  CHECK_THROWS_WITH(
      Journal(folder.path("none/r.json"), kContext, false),
      Contains(folder.path("none/r.json")) && Contains("cannot write: No such file or directory"));
}

TEST_CASE("a disk that takes no more is told when a cell is appended", "[unit]") {
  if (!fs::exists("/dev/full")) return;
  const test::TemporaryFolder folder;
  // The journal is written to a temporary name and renamed; from then on its path leads to the full
  // device.
  const std::string out = folder.path("r.json");
  fs::create_symlink("/dev/full", out + ".new");
  CHECK_THROWS_WITH(write_file_atomically(out, "text"),
                    Contains(out) && Contains("No space left on device"));
  CHECK_FALSE(fs::exists(out));
}

TEST_CASE("a file is written whole or not at all, and no temporary file stays", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string path = folder.path("r.json");
  write_file_atomically(path, "first");
  CHECK(read_text_file(path) == "first");
  write_file_atomically(path, std::string(1 << 20, 'x'));
  CHECK(read_text_file(path).size() == 1 << 20);
  CHECK(files_in(folder) == 1);

  fs::create_directory(folder.path("taken"));
  CHECK_THROWS_WITH(write_file_atomically(folder.path("taken"), "x"),
                    Contains(folder.path("taken")) && Contains("cannot write"));
  CHECK_THROWS_WITH(write_file_atomically(folder.path("none/r.json"), "x"),
                    Contains("No such file or directory"));
  CHECK(files_in(folder) == 2);
  // A write that fails keeps the earlier file.
  fs::create_directory(path + ".new");
  CHECK_THROWS_AS(write_file_atomically(path, "y"), InputError);
  CHECK(read_text_file(path).size() == 1 << 20);
}

TEST_CASE("a reader never sees a half-written file", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string path = folder.path("r.json");
  write_file_atomically(path, std::string(100000, 'a'));
  // A reader that opened the old file keeps it whole while the new one takes the name.
  std::ifstream reader(path, std::ios::binary);
  write_file_atomically(path, std::string(50000, 'b'));
  const std::string seen{std::istreambuf_iterator<char>(reader), {}};
  CHECK(seen == std::string(100000, 'a'));
  CHECK(read_text_file(path) == std::string(50000, 'b'));
}

TEST_CASE("asking whether a path can be written changes nothing", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("r.json", "kept");
  check_writable(path);
  check_writable(folder.path("new.json"));
  CHECK(read_text_file(path) == "kept");
  CHECK(files_in(folder) == 1);
  CHECK_THROWS_WITH(check_writable(folder.path("")), Contains("it is a folder"));
  CHECK_THROWS_WITH(check_writable(folder.path("none/r.json")),
                    Contains("No such file or directory"));
}

TEST_CASE("numbers that JSON cannot hold are null", "[unit]") {
  using Limits = std::numeric_limits<double>;
  for (const double bad : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()})
    CHECK(number_or_null(bad).is_null());
  CHECK(number_or_null(std::nullopt).is_null());
  for (const double good : {0.0, -1.5, Limits::max(), Limits::denorm_min()}) {
    const Json json = number_or_null(good);
    REQUIRE(json.is_number());
    CHECK(Json::parse(json.dump()).get<double>() == good);  // to the last bit
  }
}

TEST_CASE("a cell that did not run is a valid row with its status and reason", "[unit]") {
  for (const CellStatus status :
       {CellStatus::unsupported, CellStatus::failed, CellStatus::skipped}) {
    const Json results = results_of_a_refused_cell(status, "because");
    check_schema(results, "results/results.schema.json", "test");
    CHECK(results["cells"][0]["status"] == std::string(status_name(status)));
    CHECK(results["cells"][0]["reason"] == "because");
    CHECK(results["cells"][0]["rows"].empty());
  }
}

TEST_CASE("results that break the schema are told by their place and are not written", "[unit]") {
  const test::TemporaryFolder folder;
  const Json good = results_of_a_refused_cell(CellStatus::failed, "because");
  const auto refused = [&](const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    CHECK_THROWS_AS(write_results(bad, folder.path("r.json")), InputError);
    CHECK(files_in(folder) == 0);
  };
  refused([](Json& r) { r["schema_version"] = kResultsSchemaVersion + 1; });
  refused([](Json& r) { r.erase("context"); });
  refused([](Json& r) { r["cells"][0]["status"] = "fine"; });
  refused([](Json& r) { r["cells"][0]["stauts"] = "ok"; });
  refused([](Json& r) { r["cells"][0]["seed"] = -1; });
  refused([](Json& r) { r["cells"][0]["rows"].push_back(Json::object()); });
  write_results(good, folder.path("r.json"));
  CHECK(Json::parse(read_text_file(folder.path("r.json"))) == good);
}

TEST_CASE("every committed results file follows the schema", "[unit]") {
  std::size_t checked = 0;
  for (const auto& file : fs::directory_iterator(fs::path(KOKSMA_SOURCE_DIR) / "results")) {
    if (file.path().extension() != ".json") continue;
    const Json results = Json::parse(read_text_file(file.path().string()));
    if (results.contains("device_checks")) {
      INFO(file.path().string());
      CHECK_NOTHROW(check_schema(results, "results/stability.schema.json", file.path().string()));
      ++checked;
      continue;
    }
    // Of the program's own files, those of a run have cells.
    if (!results.contains("schema_version") || !results.contains("cells")) continue;
    const std::string name = file.path().filename().string();
    INFO(name);
    CHECK_NOTHROW(check_schema(results, "results/results.schema.json", name));
    ++checked;
  }
  CHECK(checked > 0);
}

TEST_CASE("bytes that are no UTF-8 do not lose what was measured", "[unit]") {
  const test::TemporaryFolder folder;
  const Json results = results_of_a_refused_cell(CellStatus::failed, "the compiler said \xE9\xFF");
  { Journal(folder.path("r.json"), kContext, false).append(identity(1), results["cells"][0]); }
  CHECK(Journal(folder.path("r.json"), kContext, true).taken_over() == 1);
  write_results(results, folder.path("r.json"));
  const Json written = Json::parse(read_text_file(folder.path("r.json")));
  CHECK_THAT(written["cells"][0]["reason"].get<std::string>(), Contains("the compiler said"));
}
