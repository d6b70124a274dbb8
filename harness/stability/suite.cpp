#include "stability/suite.hpp"

#include <fmt/format.h>

#include <set>

#include "catalog/embedded.hpp"
#include "catalog/json.hpp"

namespace koksma {
namespace {

// The cells of a scene that no entry lists.
constexpr const char* kUsualCells = "harness/stability/usual.json";

// A case as the block of a study.
Json block_of(const Integrand& f, const Json& given) {
  const Scene scene = scene_of(f, given["d"], given["parameters"]);
  Json block = {{"scenes", {scene.text}},
                {"samplers", {given["sampler"]}},
                {"n", given["n"]},
                {"replicates", given["replicates"]},
                {"precision", given.value("precision", "fp64")}};
  for (const char* key : {"estimator", "sum"})
    if (given.contains(key)) block[key] = given[key];
  return block;
}

std::optional<Interval> range_of(const Json& given, const char* key) {
  if (!given.contains(key)) return std::nullopt;
  return Interval{given[key][0], given[key][1]};
}

Demand demand_of(const Json& given) {
  return {given["verdict"],        given.value("overflow", false), given.value("held_by", ""),
          range_of(given, "bias"), range_of(given, "digits"),      given["note"]};
}

class SuiteBuilder {
 public:
  explicit SuiteBuilder(const Catalog& catalog) : catalog_(catalog) {
    json_["title"] = "stability";
    json_["cells"] = Json::array();
  }

  void add_cases(const Integrand& f, const std::string& only_scene = "") {
    for (const Json& given : f.stability) {
      Json block = block_of(f, given);
      if (!only_scene.empty() && block["scenes"][0] != only_scene) continue;
      add(std::move(block), demand_of(given), f.code.path);
    }
  }

  void add_usual(const std::string& scene) {
    const Json usual = parse_json(embedded_text(kUsualCells), kUsualCells);
    const Json& cells = usual["cells"];
    for (Json block : cells) {
      block["scenes"] = {scene};
      add(std::move(block), std::nullopt, "--scene");
    }
  }

  Suite finish() {
    suite_.study = study_from(catalog_, json_, "the stability suite");
    return std::move(suite_);
  }

 private:
  // Read at once, so that an error names the entry.
  void add(Json block, std::optional<Demand> demand, const std::string& where) {
    study_from(catalog_, {{"cells", Json::array({block})}}, where);
    json_["cells"].push_back(std::move(block));
    suite_.demands.push_back(std::move(demand));
  }

  const Catalog& catalog_;
  Json json_;
  Suite suite_;
};

}  // namespace

Suite full_suite(const Catalog& catalog) {
  SuiteBuilder builder(catalog);
  for (const Integrand& f : catalog.integrands) builder.add_cases(f);
  return builder.finish();
}

Suite suite_of(const Catalog& catalog, const std::vector<std::string>& scenes) {
  SuiteBuilder builder(catalog);
  std::set<std::string> seen;
  for (const std::string& text : scenes) {
    const Scene scene = parse_scene(catalog, text, "--scene");
    if (!seen.insert(text).second) continue;
    const Integrand& f = catalog.integrand(scene.integrand, "--scene");
    builder.add_cases(f, text == f.name ? "" : scene.text);
    builder.add_usual(scene.text);
  }
  return builder.finish();
}

}  // namespace koksma
