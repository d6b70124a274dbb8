// The catalog: everything in kernels/ and integrands/ is embedded and loads, entries that are wrong
// are told by file and place, a user's pair of files joins without a rebuild, and no name is
// written in C++.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>

#include "catalog/embedded.hpp"
#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;

// A user's pair: an embedded entry and its code under a name of its own.
struct OwnPair {
  test::TemporaryFolder folder;
  Json entry;
  std::string json_path;

  OwnPair() {
    const Integrand& model = test::catalog().integrand("linear-prod", "test");
    const std::string& code_path = model.code.path;
    entry = parse_json(embedded_text(code_path.substr(0, code_path.size() - 3) + ".json"), "test");
    entry["name"] = "my-own";
    folder.write("mine.cl", model.code.text);
    save();
  }
  void save() { json_path = folder.write("mine.json", entry.dump(2)); }
  // The message that the pair is refused with.
  std::string refusal() {
    save();
    try {
      load_catalog({json_path});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

// String literals of C++ source, comments and includes left out.
std::vector<std::string> string_literals(const std::string& source) {
  static const std::regex token(
      R"re(//[^\n]*|/\*[^]*?\*/|#include[^\n]*|'(\\.|[^'\\])'|R"\(([^]*?)\)"|"((\\.|[^"\\\n])*)")re");
  std::vector<std::string> found;
  for (auto it = std::sregex_iterator(source.begin(), source.end(), token);
       it != std::sregex_iterator(); ++it)
    if ((*it)[2].matched || (*it)[3].matched) found.push_back((*it)[2].str() + (*it)[3].str());
  return found;
}

// The catalog's names of more than five letters, but for those that OpenCL C has as a type.
std::vector<std::string> names_of_the_catalog() {
  std::vector<std::string> names;
  const auto add = [&](const auto& entries) {
    for (const auto& e : entries)
      if (e.name.size() > 5 && e.name != "double") names.push_back(e.name);
  };
  add(test::catalog().samplers);
  add(test::catalog().integrands);
  add(test::catalog().sums);
  return names;
}

// Samplers whose name is an everyday word of prose too: random, regular, stratified, …
bool is_everyday_word(const std::string& name) {
  const auto& samplers = test::catalog().samplers;
  return name.find('-') == std::string::npos &&
         std::any_of(samplers.begin(), samplers.end(),
                     [&](const Sampler& s) { return s.name == name; });
}

// The word in the text, not as a part of a longer one. By hand: a regular expression per name and
// literal takes seconds.
bool holds_word(const std::string& text, const std::string& word) {
  const auto is_part = [&](std::size_t at) {
    const auto c = static_cast<unsigned char>(text[at]);
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
  };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_part(at - 1)) && (end == text.size() || !is_part(end))) return true;
  }
  return false;
}

// The name in the text as a word of its own, or as the whole text where prose may hold the word; ""
// if there is none.
std::string name_in(const std::string& text, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (text == name || (!is_everyday_word(name) && holds_word(text, name))) return name;
  return "";
}

}  // namespace

TEST_CASE(
    "every .cl and .json of kernels/ and integrands/ is embedded as it is, and nothing else of "
    "them",
    "[unit]") {
  std::vector<std::string> on_disk;
  for (const char* top : {"kernels", "integrands"}) {
    for (const auto& file : fs::recursive_directory_iterator(fs::path(KOKSMA_SOURCE_DIR) / top)) {
      if (file.path().extension() != ".cl" && file.path().extension() != ".json") continue;
      on_disk.push_back(fs::relative(file.path(), KOKSMA_SOURCE_DIR).string());
      INFO(on_disk.back());
      CHECK(embedded_text(on_disk.back()) == test::repository_file(on_disk.back()));
    }
  }
  std::size_t embedded = 0;
  for (const EmbeddedFile& file : embedded_files())
    embedded += file.path.starts_with("kernels/") || file.path.starts_with("integrands/") ? 1 : 0;
  CHECK(embedded == on_disk.size());
}

TEST_CASE("the embedded catalog loads, and every entry has its code", "[unit]") {
  const Catalog& catalog = test::catalog();
  CHECK(catalog.families.size() >= 3);
  CHECK(catalog.samplers.size() >= 8);
  CHECK(catalog.integrands.size() >= 13);
  CHECK(catalog.sums.size() >= 3);
  CHECK(catalog.estimators.size() >= 3);
  const auto has_code = [](const auto& entries) {
    for (const auto& e : entries) {
      INFO(e.name);
      CHECK(e.code.path.ends_with(".cl"));
      CHECK(e.code.text == test::repository_file(e.code.path));
    }
  };
  has_code(catalog.families);
  has_code(catalog.integrands);
  has_code(catalog.transforms);
  has_code(catalog.sums);
  for (const Sampler& s : catalog.samplers) {
    INFO(s.name);
    CHECK(catalog.family(s.family).name == s.family);
    CHECK(fits(catalog.estimator(s.default_estimator, "test"), s));
  }
}

TEST_CASE(
    "every .cl of integrands/, sums/, solvers/, transforms/ and points/ belongs to an entry, and "
    "those of counting/, general/, quality/ and stability/ are asked for",
    "[unit]") {
  std::set<std::string> owned;
  const auto own = [&](const auto& entries) {
    for (const auto& e : entries) owned.insert(e.code.path);
  };
  for (const Family& family : test::catalog().families)
    for (const auto* pieces : {&family.parts, &family.preparations})
      for (const SourceFile& piece : *pieces) owned.insert(piece.path);
  for (const Integrand& f : test::catalog().integrands)
    for (const SourceFile& part : f.parts) owned.insert(part.path);
  own(test::catalog().families);
  own(test::catalog().integrands);
  own(test::catalog().transforms);
  own(test::catalog().filters);
  own(test::catalog().sums);
  own(test::catalog().solvers);
  for (const SourceFile& part : test::catalog().solver_parts) owned.insert(part.path);
  for (const Family& family : test::catalog().families)
    owned.insert(fmt::format("kernels/general/{}.cl", family.name));
  for (const char* stage : {"plan", "quality", "stability"})
    for (const auto& file : fs::directory_iterator(fs::path(KOKSMA_SOURCE_DIR) / "harness" / stage))
      for (const std::string& literal : string_literals(read_text_file(file.path().string())))
        for (const std::string& path :
             {literal, "kernels/" + std::string(stage) + "/" + literal + ".cl"})
          owned.insert(path);
  owned.insert("kernels/stability/add-up.cl");  // behind every sum of a self-test
  for (const EmbeddedFile& file : embedded_files()) {
    if (!file.path.ends_with(".cl") ||
        (file.path.starts_with("kernels/") && file.path.find('/', 8) == std::string_view::npos))
      continue;
    INFO(file.path);
    CHECK(owned.count(std::string(file.path)) == 1);
  }
}

TEST_CASE("names are told apart: no sampler, integrand, sum or estimator exists twice", "[unit]") {
  const auto unique = [](const auto& entries) {
    std::set<std::string> seen;
    for (const auto& e : entries) {
      INFO(e.name);
      CHECK(seen.insert(e.name).second);
    }
  };
  unique(test::catalog().families);
  unique(test::catalog().samplers);
  unique(test::catalog().integrands);
  unique(test::catalog().sums);
  unique(test::catalog().estimators);
}

TEST_CASE("a user's pair of files is an integrand like any other", "[unit]") {
  const OwnPair own;
  const Catalog catalog = load_catalog({own.json_path});
  CHECK(catalog.integrands.size() == test::catalog().integrands.size() + 1);
  const Integrand& f = catalog.integrand("my-own", "test");
  CHECK(f.code.path == own.folder.path("mine.cl"));
  CHECK(f.parameters.size() == test::catalog().integrand("linear-prod", "test").parameters.size());
  CHECK_FALSE(f.expected.empty());
}

TEST_CASE("rates may depend on a parameter over d, and the fourth moment may be stated", "[unit]") {
  OwnPair own;
  const auto read = [&] {
    own.save();
    const Catalog catalog = load_catalog({own.json_path});
    return catalog.integrand("my-own", "test");
  };
  CHECK(read().fourth_moment == FourthMoment::estimated);
  own.entry["exact"]["kurtosis"] = {{"from", "indicator"}, {"source", "test"}};
  CHECK(read().fourth_moment == FourthMoment::indicator);
  own.entry["exact"]["kurtosis"]["from"] = "unknown";
  own.entry["expected"]["iid"] = {
      {"constant", -1}, {"per_parameter_over_dimension", {{"power", 0.5}}}, {"source", "test"}};
  const Integrand f = read();
  CHECK(f.fourth_moment == FourthMoment::unknown);
  const auto& factors = f.expected.at("iid").per_parameter_over_dimension;
  REQUIRE(factors.size() == 1);
  CHECK(f.parameters[factors[0].parameter].name == "power");
  CHECK(factors[0].value == 0.5);
  own.entry["expected"]["iid"]["per_parameter_over_dimension"] = {{"powr", 0.5}};
  CHECK_THAT(own.refusal(), Contains("per_parameter_over_dimension") && Contains("power"));
}

TEST_CASE("a user's entry without code, or code without entry, is told by its path", "[unit]") {
  const OwnPair own;
  fs::remove(own.folder.path("mine.cl"));
  CHECK_THROWS_WITH(load_catalog({own.json_path}),
                    Contains(own.folder.path("mine.cl")) && Contains("cannot be read"));
  CHECK_THROWS_WITH(load_catalog({own.folder.path("none.json")}),
                    Contains(own.folder.path("none.json")) && Contains("cannot be read"));
  CHECK_THROWS_WITH(load_catalog({own.folder.path("mine.cl")}), Contains("does not end in .json"));
}

TEST_CASE("malformed JSON names the file, the line and the column", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string path =
      folder.write("bad.json", "{\n  \"name\": \"x\",\n  \"title\" \"y\"\n}\n");
  folder.write("bad.cl", "");
  CHECK_THROWS_AS(load_catalog({path}), InputError);
  CHECK_THROWS_WITH(load_catalog({path}), Contains(path) && Contains("line 3, column 13"));
  CHECK_THROWS_WITH(parse_json("", "empty.json"),
                    Contains("empty.json") && Contains("line 1, column 1"));
}

TEST_CASE("an unknown key names the file and the JSON pointer and suggests the nearest", "[unit]") {
  OwnPair own;
  own.entry["citatoin"] = "x";
  CHECK_THAT(own.refusal(), Contains(own.json_path + ", at '/citatoin'") &&
                                Contains("unknown key 'citatoin'") &&
                                Contains("did you mean 'citation'?"));
  own.entry.erase("citatoin");
  own.entry["parameters"][1]["defualt"] = 1;
  CHECK_THAT(own.refusal(),
             Contains("at '/parameters/1/defualt'") && Contains("did you mean 'default'?"));
  own.entry["parameters"][1].erase("defualt");
  own.entry["exact"]["mean"]["sorce"] = "x";
  CHECK_THAT(own.refusal(),
             Contains("at '/exact/mean/sorce'") && Contains("did you mean 'source'?"));
  own.entry["exact"]["mean"].erase("sorce");
  own.entry["expected"]["net-owen"] = {{"constnat", -1}, {"source", "x"}};
  CHECK_THAT(own.refusal(),
             Contains("at '/expected/net-owen/constnat'") && Contains("did you mean 'constant'?"));
  own.entry.erase("expected");
  CHECK(own.refusal().empty());
}

TEST_CASE("a value of the wrong kind names its JSON pointer, what was found and the schema",
          "[unit]") {
  OwnPair own;
  own.entry["parameters"][0]["max"] = "ten";
  CHECK_THAT(own.refusal(), Contains("at '/parameters/0/max'") && Contains("found \"ten\"") &&
                                Contains("integrand.schema.json"));
  own.entry["parameters"][0]["max"] = 10;
  own.entry.erase("dimensions");
  CHECK_THAT(own.refusal(), Contains(own.json_path) && Contains("dimensions"));
}

TEST_CASE("unknown classes and transforms are told with the nearest spelling", "[unit]") {
  OwnPair own;
  const Json good = own.entry;
  own.entry["class"] = "smoth";
  CHECK_THAT(own.refusal(), Contains("at '/class'") && Contains("unknown class 'smoth'") &&
                                Contains("did you mean 'smooth'?"));
  own.entry = good;
  own.entry["transforms"] = {"nromal"};
  CHECK_THAT(own.refusal(), Contains("at '/transforms'") &&
                                Contains("unknown transform 'nromal'") &&
                                Contains("did you mean 'normal'?"));
}

TEST_CASE("a name that exists already is refused, and says where it is defined", "[unit]") {
  OwnPair own;
  const auto& integrands = test::catalog().integrands;
  // Each refusal loads the catalog anew: the first and the last are met.
  for (const Integrand& f : {integrands.front(), integrands.back()}) {
    own.entry["name"] = f.name;
    CHECK_THAT(own.refusal(), Contains("at '/name'") &&
                                  Contains("'" + f.name + "' exists already") &&
                                  Contains(f.code.path));
  }
  own.entry["name"] = "my-own";
  own.save();
  CHECK_THROWS_WITH(load_catalog({own.json_path, own.json_path}),
                    Contains("'my-own' exists already"));
}

TEST_CASE("a part that is not there is told with the nearest name, and one that is there is known",
          "[unit]") {
  OwnPair own;
  const auto& integrands = test::catalog().integrands;
  const auto with_parts = std::find_if(integrands.begin(), integrands.end(),
                                       [](const Integrand& f) { return !f.parts.empty(); });
  REQUIRE(with_parts != integrands.end());
  const std::string name = fs::path(with_parts->parts.front().path).stem().string();
  own.entry["parts"] = {name + "x"};
  CHECK_THAT(own.refusal(), Contains("at '/parts'") && Contains("'" + name + "'"));
}

TEST_CASE("defaults outside their ranges and parameters that clash are refused", "[unit]") {
  OwnPair own;
  const Json good = own.entry;
  own.entry["parameters"][0]["default"] = 1e6;
  CHECK_THAT(own.refusal(), Contains("at '/parameters/0/default'") && Contains("allowed: "));
  own.entry = good;
  own.entry["dimensions"] = {{"min", 2}, {"max", 4}, {"default", 5}};
  CHECK_THAT(own.refusal(), Contains("at '/dimensions/default'") && Contains("allowed: 2 to 4"));
  own.entry = good;
  own.entry["parameters"][1]["name"] = own.entry["parameters"][0]["name"];
  CHECK_THAT(own.refusal(), Contains("at '/parameters/1/name'") && Contains("is taken"));
  own.entry["parameters"][1]["name"] = "d";
  CHECK_THAT(own.refusal(), Contains("at '/parameters/1/name'") && Contains("d is the dimension"));
}

TEST_CASE(
    "lookups of unknown names say where they came from, suggest the nearest and list what there is",
    "[unit]") {
  const Catalog& catalog = test::catalog();
  CHECK_THROWS_WITH(catalog.sampler("sobol-own", "--sampler"),
                    Contains("--sampler: unknown sampler 'sobol-own'") &&
                        Contains("did you mean 'sobol-owen'?") && Contains("random"));
  CHECK_THROWS_WITH(
      catalog.integrand("kiester", "here"),
      Contains("here: unknown integrand 'kiester'") && Contains("did you mean 'keister'?"));
  CHECK_THROWS_WITH(catalog.sum("kahn", "--sum"), Contains("did you mean 'kahan'?"));
  CHECK_THROWS_WITH(catalog.estimator("rqcm", "--estimator"), Contains("did you mean 'rqmc'?"));
  // Nothing is near: no suggestion, but the list.
  CHECK_THROWS_WITH(catalog.sampler("zzzzzzzzzzzzzzzz", "x"),
                    !Contains("did you mean") && Contains("known: "));
}

TEST_CASE("no C++ file of the harness writes the name of a sampler, an integrand or a sum",
          "[unit]") {
  const auto names = names_of_the_catalog();
  REQUIRE(names.size() > 20);
  // The scan sees what it must and leaves what it may.
  const auto found = string_literals(
      "// \"keister\"\n#include \"random\"\nf(\"one of keister, x\", '\"', R\"(lattice)\"); "
      "g(\"sobol-owens\");");
  REQUIRE(found == std::vector<std::string>{"one of keister, x", "lattice", "sobol-owens"});
  CHECK(name_in(found[0], names) == "keister");
  CHECK(name_in(found[1], names) == "lattice");
  CHECK(name_in(found[2], names).empty());

  std::size_t files = 0;
  for (const auto& file :
       fs::recursive_directory_iterator(fs::path(KOKSMA_SOURCE_DIR) / "harness")) {
    if (file.path().extension() != ".cpp" && file.path().extension() != ".hpp") continue;
    ++files;
    for (const std::string& literal : string_literals(read_text_file(file.path().string()))) {
      INFO(file.path().string() << ": \"" << literal << "\"");
      CHECK(name_in(literal, names).empty());
    }
  }
  CHECK(files > 40);
}
