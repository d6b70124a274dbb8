// From text and flags to cells: everything that is wrong with a study is told before any device
// work, with the flag or the file and JSON pointer, what was found and what is allowed.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "catalog/sizes.hpp"
#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

// A study file of one block.
struct StudyFile {
  test::TemporaryFolder folder;
  Json json = {{"title", "test"},
               {"n", "2^6"},
               {"cells", {{{"scenes", {"linear-prod:d=3"}}, {"samplers", {"sobol-owen"}}}}}};
  StudyFlags flags;

  Json& block() { return json["cells"][0]; }
  std::string path() const { return folder.path("s.json"); }
  Study read() const {
    folder.write("s.json", json.dump(1));
    return read_study(test::catalog(), path(), flags);
  }
  std::string refusal() const {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

bool needs_parameters(const Sampler& s) {
  return std::any_of(s.parameters.begin(), s.parameters.end(),
                     [](const SamplerParameter& p) { return p.required; });
}

template <typename Keep>
const Sampler& any_sampler(Keep keep) {
  const auto& all = test::catalog().samplers;
  return *std::find_if(all.begin(), all.end(), keep);
}

}  // namespace

TEST_CASE("a study becomes its cells, scene by scene and sampler by sampler", "[unit]") {
  StudyFile file;
  file.json["seed"] = 7;
  file.json["replicates"] = 5;
  file.json["cells"] = {{{"scenes", {"linear-prod:d=3", "keister"}},
                         {"samplers", {"sobol-owen", "sobol"}},
                         {"precision", "fp32"}},
                        {{"scenes", {"linear-prod:d=2"}},
                         {"samplers", {"random"}},
                         {"n", "100,10"},
                         {"replicates", 3},
                         {"sum", "kahan"},
                         {"estimator", "mc"}}};
  const Study study = file.read();
  REQUIRE(study.cells.size() == 5);
  CHECK(study.title == "test");
  CHECK(study.seed == 7);
  CHECK(study.cells[1].scene.text == "linear-prod:d=3");
  CHECK(study.cells[1].sampler == "sobol");
  CHECK(study.cells[1].estimator == "qmc");
  CHECK(study.cells[1].replicates == 1);  // nothing random in it
  CHECK(study.cells[2].scene.integrand == "keister");
  CHECK(study.cells[2].replicates == 5);
  CHECK(study.cells[2].precision == Precision::fp32);
  CHECK(study.cells[2].n == std::vector<std::uint64_t>{64});
  CHECK(study.cells[4].n == std::vector<std::uint64_t>{10, 100});
  CHECK(study.cells[4].replicates == 3);
  CHECK(study.cells[4].sum == "kahan");
  CHECK_FALSE(study.cells[4].precision);
  for (const Cell& cell : study.cells) CHECK(cell.seed == 7);
}

TEST_CASE("the default study has at least 6 scenes and 6 samplers, N to 2^18 and 32 replicates",
          "[unit]") {
  const Study study = read_study(test::catalog(), "", {});
  std::set<std::string> scenes, samplers;
  for (const Cell& cell : study.cells) {
    scenes.insert(cell.scene.integrand);
    samplers.insert(cell.sampler);
    CHECK(cell.n.back() == 1ULL << 18);
    CHECK(cell.replicates ==
          (test::catalog().estimator(cell.estimator, "test").replicated ? 32U : 1U));
  }
  CHECK(scenes.size() >= 6);
  CHECK(samplers.size() >= 6);
  CHECK(study.cells.size() >= scenes.size() * samplers.size());
}

TEST_CASE("flags override the study, whatever level set the value", "[unit]") {
  StudyFile file;
  file.json["replicates"] = 5;
  file.json["precision"] = "fp64";
  file.block()["n"] = "2^7";
  file.block()["replicates"] = 6;
  file.block()["precision"] = "fp64";
  file.block()["sum"] = "kahan";
  file.block()["estimator"] = "qmc";
  file.flags.n = "2^5,2^6";
  file.flags.precision = "fp32";
  file.flags.sum = "naive";
  file.flags.estimator = "rqmc";
  file.flags.replicates = 9;
  file.flags.seed = 11;
  file.flags.scenes = {"keister:d=2", "linear-prod"};
  file.flags.samplers = {"sobol-shift", "lattice-shift", "sobol-owen"};
  const Study study = file.read();
  REQUIRE(study.cells.size() == 6);
  for (const Cell& cell : study.cells) {
    CHECK(cell.n == std::vector<std::uint64_t>{32, 64});
    CHECK(cell.precision == Precision::fp32);
    CHECK(cell.sum == "naive");
    CHECK(cell.estimator == "rqmc");
    CHECK(cell.replicates == 9);
    CHECK(cell.seed == 11);
  }
  CHECK(study.cells[3].scene.integrand == "linear-prod");
  // The study in the results is the one that ran: read again without flags, it gives the same
  // cells.
  const Study again =
      read_study(test::catalog(), file.folder.write("again.json", study.verbatim.dump()), {});
  REQUIRE(again.cells.size() == study.cells.size());
  for (std::size_t i = 0; i < again.cells.size(); ++i) {
    CHECK(again.cells[i].scene.text == study.cells[i].scene.text);
    CHECK(again.cells[i].sampler == study.cells[i].sampler);
    CHECK(again.cells[i].n == study.cells[i].n);
    CHECK(again.cells[i].replicates == study.cells[i].replicates);
    CHECK(again.cells[i].precision == study.cells[i].precision);
    CHECK(again.cells[i].sum == study.cells[i].sum);
    CHECK(again.cells[i].estimator == study.cells[i].estimator);
  }
}

TEST_CASE(
    "a scene alone runs under the study's samplers, a sampler alone on its scenes, each cell once",
    "[unit]") {
  const Study all = read_study(test::catalog(), "", {});
  StudyFlags one_scene;
  one_scene.scenes = {"linear-prod:d=2"};
  std::set<std::string> samplers;
  for (const Cell& cell : all.cells) samplers.insert(cell.sampler);
  CHECK(read_study(test::catalog(), "", one_scene).cells.size() == samplers.size());
  StudyFlags one_sampler;
  one_sampler.samplers = {"random"};
  CHECK(read_study(test::catalog(), "", one_sampler).cells.size() * samplers.size() ==
        all.cells.size());
}

TEST_CASE("unknown names in a study are told by file and JSON pointer with the nearest spelling",
          "[unit]") {
  StudyFile file;
  file.block()["samplers"] = {"sobol", "sobol-oven"};
  CHECK_THAT(file.refusal(),
             Contains(file.path() + ", at '/cells/0/samplers/1': unknown sampler 'sobol-oven'") &&
                 Contains("did you mean 'sobol-owen'?"));
  file.block()["samplers"] = {"sobol"};
  file.block()["scenes"] = {"linear-prod", "keisterr"};
  CHECK_THAT(file.refusal(), Contains("at '/cells/0/scenes/1': unknown integrand 'keisterr'") &&
                                 Contains("did you mean 'keister'?"));
  file.block()["scenes"] = {"linear-prod:d=0"};
  CHECK_THAT(file.refusal(), Contains("at '/cells/0/scenes/0': d = 0 is out of range"));
  file.block()["scenes"] = {"linear-prod"};
  file.block()["estimator"] = "qmcc";
  CHECK_THAT(file.refusal(), Contains("at '/cells/0/estimator': unknown estimator 'qmcc'") &&
                                 Contains("did you mean 'qmc'?"));
  file.block().erase("estimator");
  file.json["sum"] = "naiv";
  CHECK_THAT(file.refusal(),
             Contains("at '/sum': unknown sum 'naiv'") && Contains("did you mean 'naive'?"));
}

TEST_CASE("unknown names in flags are told by the flag", "[unit]") {
  StudyFile file;
  file.flags.samplers = {"radnom"};
  CHECK_THAT(file.refusal(),
             Contains("--sampler: unknown sampler 'radnom'") && Contains("did you mean 'random'?"));
  file.flags = {};
  file.flags.scenes = {"isigami"};
  CHECK_THAT(file.refusal(), Contains("--scene: unknown integrand 'isigami'") &&
                                 Contains("did you mean 'ishigami'?"));
  file.flags = {};
  file.flags.estimator = "rqmcc";
  CHECK_THAT(file.refusal(), Contains("--estimator: unknown estimator 'rqmcc'") &&
                                 Contains("did you mean 'rqmc'?"));
  file.flags = {};
  file.flags.sum = "kahann";
  CHECK_THAT(file.refusal(),
             Contains("--sum: unknown sum 'kahann'") && Contains("did you mean 'kahan'?"));
  file.flags = {};
  file.flags.n = "2^x";
  CHECK_THAT(file.refusal(), Contains("--n: '2^x'"));
}

TEST_CASE("malformed studies and unknown keys name the file and the place", "[unit]") {
  StudyFile file;
  CHECK_THROWS_WITH(
      read_study(test::catalog(), file.folder.write("m.json", "{\n \"cells\": [}\n"), {}),
      Contains("m.json: malformed JSON") && Contains("line 2, column 12"));
  CHECK_THROWS_WITH(read_study(test::catalog(), file.folder.path("none.json"), {}),
                    Contains("none.json: the file cannot be read"));
  CHECK_THROWS_WITH(read_study(test::catalog(), file.folder.path(""), {}),
                    Contains("cannot be read"));
  file.json["replicate"] = 3;
  CHECK_THAT(file.refusal(), Contains(file.path() + ", at '/replicate': unknown key 'replicate'") &&
                                 Contains("did you mean 'replicates'?"));
  file.json.erase("replicate");
  file.block()["sampler"] = {"sobol"};
  CHECK_THAT(file.refusal(), Contains("at '/cells/0/sampler': unknown key 'sampler'") &&
                                 Contains("did you mean 'samplers'?"));
}

TEST_CASE("values of the wrong kind or out of range in a study name their JSON pointer", "[unit]") {
  const auto refused = [](const std::string& pointer, const Json& value) {
    StudyFile file;
    file.json[Json::json_pointer(pointer)] = value;
    INFO(pointer << " = " << value);
    const std::string message = file.refusal();
    CHECK_THAT(message, Contains("at '" + pointer + "'") && Contains("found " + value.dump()));
  };
  for (const Json& bad : {Json(-1), Json(1.5), Json("1"), Json(1e30), Json(std::uint64_t{1} << 63)})
    refused("/seed", bad);
  for (const Json& bad : {Json(0), Json(65537), Json(2.5), Json("8"), Json(-3)})
    refused("/replicates", bad);
  refused("/cells/0/replicates", 0);
  refused("/precision", "fp16");
  refused("/cells/0/precision", 64);
  refused("/n", 1024);
  refused("/cells", Json::array());
  refused("/cells/0/scenes", "keister");
  refused("/cells/0/samplers", Json::array());
  refused("/cells/0/scenes/0", 1);
}

TEST_CASE("an N that a sampler can not give names the nearest that it can", "[unit]") {
  StudyFile file;
  std::set<std::string> forms;
  for (const Sampler& s : test::catalog().samplers) {
    if (needs_parameters(s)) continue;
    const std::uint32_t d = std::min(2U, s.max_dim);
    file.block()["samplers"] = {s.name};
    file.block()["scenes"] = {fmt::format("linear-prod:d={}", d)};
    file.json["n"] = "997";  // a prime
    INFO(s.name);
    if (s.size_form == "any") {
      CHECK(file.refusal().empty());
      continue;
    }
    forms.insert(s.size_form);
    const std::map<std::string, std::string> nearest{{"even", "996 and 998"},
                                                     {"power-of-two", "512 and 1024"},
                                                     {"power-of-d", "961 and 1024"},
                                                     {"twice-power-of-d", "968 and 1058"},
                                                     {"rectangle", "992 and 999"}};
    CHECK_THAT(file.refusal(),
               Contains(file.path() + ", at '/n': N = 997 for sampler '" + s.name + "'") &&
                   Contains("the nearest are " + nearest.at(s.size_form)));
  }
  CHECK(forms.count("power-of-two") == 1);
  file.block()["scenes"] = {"linear-prod:d=3"};
  file.block()["samplers"] = {
      any_sampler([](const Sampler& s) { return s.size_form == "power-of-two"; }).name};
  file.block()["n"] = "96";
  CHECK_THAT(file.refusal(), Contains("at '/cells/0/n': N = 96") && Contains("64 and 128"));
  file.flags.n = "48";
  CHECK_THAT(file.refusal(), Contains("--n: N = 48") && Contains("32 and 64"));
}

TEST_CASE("an N that a sampler does not have is told with its largest", "[unit]") {
  StudyFile file;
  for (const Sampler& s : test::catalog().samplers) {
    if (needs_parameters(s)) continue;
    INFO(s.name);
    file.flags.samplers = {s.name};
    file.flags.scenes = {fmt::format("linear-prod:d={}", std::min(2U, s.max_dim))};
    file.flags.n = fmt::format(
        "{}", *nearest_sizes(s, 2, std::uint64_t{1} << std::min(s.max_log2_n, 62U)).below);
    CHECK(file.refusal().empty());
    if (s.max_log2_n >= 62) continue;
    file.flags.n = fmt::format("2^{}", s.max_log2_n + 1);
    CHECK_THAT(
        file.refusal(),
        Contains("--n: N = ") && Contains(fmt::format("it has at most 2^{} points", s.max_log2_n)));
  }
}

TEST_CASE("more dimensions than a sampler has are refused, unless a file brings its own",
          "[unit]") {
  const Integrand& wide = test::catalog().integrand("linear-prod", "test");
  StudyFile file;
  std::size_t limited = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (s.max_dim >= wide.max_dim || needs_parameters(s)) continue;
    ++limited;
    INFO(s.name);
    file.flags = {};
    file.block()["samplers"] = {s.name};
    file.block()["scenes"] = {fmt::format("linear-prod:d={}", s.max_dim)};
    file.block()["n"] = std::to_string(*nearest_sizes(s, s.max_dim, 64).below);
    CHECK(file.refusal().empty());
    file.block()["scenes"] = {fmt::format("linear-prod:d={}", s.max_dim + 1)};
    CHECK_THAT(file.refusal(), Contains("at '/cells/0/samplers/0'") &&
                                   Contains(fmt::format("draws d = {}", s.max_dim + 1)) &&
                                   Contains(fmt::format("at most {} dimensions", s.max_dim)));
    file.flags.own_directions = true;
    CHECK(file.refusal().empty() == s.reads_directions);
  }
  CHECK(limited > 0);
}

TEST_CASE(
    "an estimator that does not fit a sampler is refused with those that do, and fits otherwise",
    "[unit]") {
  StudyFile file;
  std::size_t refused = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (needs_parameters(s)) continue;
    for (const Estimator& e : test::catalog().estimators) {
      INFO(s.name << " " << e.name);
      file.block()["samplers"] = {s.name};
      file.block()["scenes"] = {fmt::format("linear-prod:d={}", std::min(2U, s.max_dim))};
      file.block()["estimator"] = e.name;
      file.json["n"] = std::to_string(*nearest_sizes(s, std::min(2U, s.max_dim), 256).above);
      const std::string message = file.refusal();
      if (fits(e, s)) {
        CHECK(message.empty());
        continue;
      }
      ++refused;
      CHECK_THAT(message, Contains("at '/cells/0/estimator': estimator '" + e.name +
                                   "' does not fit sampler '" + s.name + "'"));
      for (const std::string& name : fitting_estimators(test::catalog(), s))
        CHECK_THAT(message.substr(message.find("these do: ")), Contains(name));
    }
  }
  CHECK(refused > 0);
  file.flags.estimator = "mc";
  file.flags.samplers = {"sobol"};
  CHECK_THAT(file.refusal(),
             Contains("--estimator: estimator 'mc' does not fit sampler 'sobol'; these do: qmc"));
}

TEST_CASE("one replicate has no t interval and is refused", "[unit]") {
  StudyFile file;
  file.json["replicates"] = 1;
  CHECK_THAT(file.refusal(), Contains(file.path() + ", at '/replicates': 1 replicate") &&
                                 Contains("'rqmc' needs at least 2"));
  file.block()["replicates"] = 1;
  CHECK_THAT(file.refusal(), Contains("at '/cells/0/replicates': 1 replicate"));
  file.flags.replicates = 1;
  CHECK_THAT(file.refusal(), Contains("--replicates: 1 replicate"));
  file.flags.replicates = 2;
  CHECK(file.read().cells[0].replicates == 2);
  file.flags.replicates = 1;
  file.flags.estimator = "qmc";
  CHECK(file.refusal().empty());
}
