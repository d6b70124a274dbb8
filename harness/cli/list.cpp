// koksma list: what the catalog and the machine hold.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "cli/verbs.hpp"
#include "device/device.hpp"
#include "error/error.hpp"
#include "study/study.hpp"

namespace koksma {
namespace {

struct ListOptions {
  std::string kind;
  std::vector<std::string> integrands;
  bool json = false;
};

Json list_scenes(const Catalog& catalog) {
  Json list = Json::array();
  for (const Integrand& f : catalog.integrands) {
    const Scene scene = parse_scene(catalog, f.name, "catalog");
    list.push_back({{"name", scene.text}, {"integrand", f.name}, {"title", f.title}});
  }
  return list;
}

const char* truth(const ExactSource& source) {
  switch (source.kind) {
    case ExactSource::Kind::formula:
    case ExactSource::Kind::mean:
      return "closed form";
    case ExactSource::Kind::constant:
      return "constant";
    case ExactSource::Kind::table:
      return "table";
    case ExactSource::Kind::undefined:
      return "no mean";
    case ExactSource::Kind::none:
      break;
  }
  return "unknown";
}

Json list_integrands(const Catalog& catalog) {
  Json list = Json::array();
  for (const Integrand& f : catalog.integrands) {
    Json parameters = Json::array();
    for (const Parameter& p : f.parameters)
      parameters.push_back({{"name", p.name},
                            {"default", p.default_value},
                            {"min", p.min},
                            {"max", p.max},
                            {"meaning", p.meaning}});
    list.push_back({{"name", f.name},
                    {"title", f.title},
                    {"class", f.smoothness},
                    {"dimensions", fmt::format("{}..{}", f.min_dim, f.max_dim)},
                    {"truth", truth(f.mean)},
                    {"source", f.mean.source},
                    {"citation", f.citation},
                    {"parameters", parameters},
                    {"file", f.code.path}});
  }
  return list;
}

Json list_samplers(const Catalog& catalog) {
  Json list = Json::array();
  for (const Sampler& s : catalog.samplers) {
    Json parameters = Json::array();
    for (const SamplerParameter& p : s.parameters)
      parameters.push_back({{"name", p.name}, {"meaning", p.meaning}, {"required", p.required}});
    if (!s.replicable)
      parameters.push_back({{"name", "randomize"},
                            {"meaning", "rotate: a random shift modulo 1 of every coordinate"},
                            {"required", false}});
    list.push_back({{"name", s.name},
                    {"title", s.title},
                    {"family", s.family},
                    {"estimators", fitting_estimators(catalog, s)},
                    {"range", s.centred ? "(0,1)" : "[0,1)"},
                    {"min_dim", s.min_dim},
                    {"max_dim", s.max_dim},
                    {"precisions", s.precisions},
                    {"max_log2_n", s.max_log2_n},
                    {"n", s.size_form},
                    {"extensible", s.extensible},
                    {"parameters", parameters},
                    {"citation", s.citation}});
  }
  return list;
}

template <typename Entries>
Json list_titled(const Entries& entries) {
  Json list = Json::array();
  for (const auto& e : entries)
    list.push_back({{"name", e.name}, {"title", e.title}, {"citation", e.citation}});
  return list;
}

Json list_all_devices() {
  Json list = Json::array();
  for (const DeviceListing& d : list_devices())
    list.push_back({{"name", fmt::format("{}:{}", d.platform, d.device)},
                    {"title", d.facts.name},
                    {"platform", d.facts.platform},
                    {"driver", d.facts.driver},
                    {"fp64", d.facts.fp64},
                    {"compute_units", d.facts.compute_units}});
  if (list.empty())
    throw NoDeviceError(
        "no OpenCL device: no platform is installed; on Debian: apt-get install pocl-opencl-icd");
  return list;
}

// Integrands by columns: what they are, where, how their integral is known and from what.
void print_integrands(const Json& list) {
  std::size_t name = 0, kind = 0, dimensions = 0;
  for (const Json& entry : list) {
    name = std::max(name, entry["name"].get<std::string>().size());
    kind = std::max(kind, entry["class"].get<std::string>().size());
    dimensions = std::max(dimensions, entry["dimensions"].get<std::string>().size());
  }
  for (const Json& entry : list) {
    const std::string source = entry["source"];
    fmt::print("{:<{}}  {:<{}}  d {:<{}}  {}{}{}; {}\n", entry["name"].get<std::string>(), name,
               entry["class"].get<std::string>(), kind, entry["dimensions"].get<std::string>(),
               dimensions, entry["truth"].get<std::string>(), source.empty() ? "" : ": ", source,
               entry["title"].get<std::string>());
  }
}

void print_list(const Json& list) {
  if (list.empty()) fmt::print("none in this version\n");
  std::size_t width = 0;
  for (const Json& entry : list) width = std::max(width, entry["name"].get<std::string>().size());
  for (const Json& entry : list) {
    fmt::print("{:<{}}  {}", entry["name"].get<std::string>(), width,
               entry["title"].get<std::string>());
    if (entry.contains("estimators"))
      fmt::print("  [{}]", fmt::join(entry["estimators"].get<std::vector<std::string>>(), ", "));
    if (entry.contains("platform"))
      fmt::print("  ({}, driver {}, {} compute units, {})", entry["platform"].get<std::string>(),
                 entry["driver"].get<std::string>(), entry["compute_units"].get<unsigned>(),
                 entry["fp64"].get<bool>() ? "fp64" : "no fp64");
    fmt::print("\n");
  }
}

int list(const ListOptions& options) {
  const Catalog catalog = load_catalog(options.integrands);
  const std::map<std::string, std::function<Json()>> kinds{
      {"scenes", [&] { return list_scenes(catalog); }},
      {"integrands", [&] { return list_integrands(catalog); }},
      {"samplers", [&] { return list_samplers(catalog); }},
      {"estimators", [&] { return list_titled(catalog.estimators); }},
      {"sums", [&] { return list_titled(catalog.sums); }},
      {"solvers", [&] { return list_titled(catalog.solvers); }},
      {"filters", [&] { return list_titled(catalog.filters); }},
      {"devices", [] { return list_all_devices(); }},
  };
  const auto found = kinds.find(options.kind);
  if (found == kinds.end()) {
    std::vector<std::string> known;
    for (const auto& [name, ignored] : kinds) known.push_back(name);
    throw unknown_name("koksma list", "kind", options.kind, known);
  }
  const Json result = found->second();
  if (options.json)
    fmt::print("{}\n", result.dump(1));
  else if (options.kind == "integrands")
    print_integrands(result);
  else
    print_list(result);
  return kAllOk;
}

}  // namespace

void add_list(CLI::App& app, Action& action) {
  auto options = std::make_shared<ListOptions>();
  CLI::App* verb = app.add_subcommand(
      "list",
      "What there is: scenes, integrands, samplers, estimators, sums, solvers, filters, devices");
  verb->add_option("kind", options->kind,
                   "scenes, integrands, samplers, estimators, sums, solvers, filters or devices")
      ->required();
  verb->add_option("--integrand", options->integrands,
                   "an integrand of your own to list too; repeatable")
      ->allow_extra_args(false);
  verb->add_flag("--json", options->json, "everything known, as JSON");
  verb->callback([options, &action] { action = [options] { return list(*options); }; });
}

}  // namespace koksma
