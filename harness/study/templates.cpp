#include "study/templates.hpp"

#include <fmt/format.h>

#include "catalog/embedded.hpp"
#include "error/error.hpp"
#include "study/study.hpp"

namespace koksma {
namespace {

constexpr std::string_view kFolder = "harness/study/studies/", kEnding = ".json";
constexpr std::string_view kClass = "class:";

Json scenes_of_class(const Catalog& catalog, std::string_view wanted) {
  Json scenes = Json::array();
  for (const Integrand& f : catalog.integrands)
    if (wanted == "*" || f.smoothness == wanted)
      scenes.push_back(parse_scene(catalog, f.name, "catalog").text);
  return scenes;
}

Json resolved(const Catalog& catalog, const Json& scenes) {
  Json result = Json::array();
  for (const std::string text : scenes) {
    if (!text.starts_with(kClass)) {
      result.push_back(text);
      continue;
    }
    for (const Json& scene : scenes_of_class(catalog, std::string_view(text).substr(kClass.size())))
      result.push_back(scene);
  }
  return result;
}

std::string_view name_of(std::string_view path) {
  return path.substr(kFolder.size(), path.size() - kFolder.size() - kEnding.size());
}

}  // namespace

std::vector<StudyTemplate> study_templates() {
  std::vector<StudyTemplate> result;
  for (const EmbeddedFile& file : embedded_files())
    if (file.path.starts_with(kFolder))
      result.push_back(
          {std::string(name_of(file.path)), parse_json(file.text, file.path).value("title", "")});
  return result;
}

Json ready_study(const Catalog& catalog, std::string_view name) {
  std::vector<std::string> known;
  for (const StudyTemplate& each : study_templates()) {
    known.push_back(each.name);
    if (each.name != name) continue;
    const std::string path = fmt::format("{}{}{}", kFolder, name, kEnding);
    Json study = parse_json(embedded_text(path), path);
    for (Json& block : study["cells"]) block["scenes"] = resolved(catalog, block["scenes"]);
    return study;
  }
  throw unknown_name("koksma study", "study", name, known);
}

}  // namespace koksma
