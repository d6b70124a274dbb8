#include "catalog/catalog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "catalog/embedded.hpp"
#include "catalog/read_entry.hpp"
#include "catalog/sampler_parameters.hpp"
#include "error/error.hpp"

namespace koksma {
namespace {

constexpr std::string_view kClassesPath = "integrands/classes.json";
constexpr std::string_view kEstimatorsPath = "harness/catalog/estimators.json";
constexpr std::string_view kIntegrandSchema = "harness/catalog/integrand.schema.json";

bool is_json_in(std::string_view path, std::string_view folder) {
  return path.starts_with(folder) && path.ends_with(".json") &&
         path.find('/', folder.size()) == std::string_view::npos;
}

SourceFile embedded_code_beside(std::string_view json_path) {
  const std::string path = std::string(json_path.substr(0, json_path.size() - 5)) + ".cl";
  return {path, std::string(embedded_text(path))};
}

// Embedded entries are what they were when the tests checked them against entry_schema(): reading
// the schemas again would be most of a command's start-up.
Json embedded_entry(std::string_view path) { return parse_json(embedded_text(path), path); }

void read_kernels(Catalog& catalog, const EmbeddedFile& file) {
  const std::string_view path = file.path;
  if (is_json_in(path, "kernels/points/")) {
    const Json entry = embedded_entry(path);
    Family family{
        entry["family"], entry["title"], entry["citation"], embedded_code_beside(path), {}, {}};
    const auto read_pieces = [&](const char* key, const char* folder) {
      std::vector<SourceFile> pieces;
      for (const Json& name : entry.value(key, Json::array())) {
        const std::string code = fmt::format("{}/{}.cl", folder, name.get<std::string>());
        pieces.push_back({code, std::string(embedded_text(code))});
      }
      return pieces;
    };
    family.parts = read_pieces("parts", "kernels/points/parts");
    family.preparations = read_pieces("preparations", "kernels/points/prepare");
    catalog.families.push_back(std::move(family));
    for (const Json& sampler : entry["samplers"])
      catalog.samplers.push_back(read_sampler(sampler, entry["family"]));
  } else if (is_json_in(path, "kernels/sums/")) {
    const Json entry = embedded_entry(path);
    catalog.sums.push_back(read_sum(entry, embedded_code_beside(path)));
  } else if (is_json_in(path, "kernels/solvers/")) {
    const Json entry = embedded_entry(path);
    catalog.solvers.push_back(read_solver(entry, embedded_code_beside(path)));
  } else if (path.starts_with("kernels/solvers/parts/")) {
    catalog.solver_parts.push_back({std::string(path), std::string(file.text)});
  } else if (is_json_in(path, "kernels/transforms/") || is_json_in(path, "kernels/filters/")) {
    const Json entry = embedded_entry(path);
    auto& list = path.starts_with("kernels/filters/") ? catalog.filters : catalog.transforms;
    list.push_back({entry["name"], entry["title"], entry["citation"], embedded_code_beside(path)});
  }
}

// What several integrands share, integrands/parts/<name>.cl.
std::vector<SourceFile> integrand_parts(const Json& entry, std::string_view path) {
  constexpr std::string_view kFolder = "integrands/parts/", kEnding = ".cl";
  std::vector<std::string> known;
  for (const EmbeddedFile& file : embedded_files())
    if (file.path.starts_with(kFolder))
      known.emplace_back(
          file.path.substr(kFolder.size(), file.path.size() - kFolder.size() - kEnding.size()));
  std::vector<SourceFile> parts;
  const Json names = entry.value("parts", Json::array());
  for (const std::string name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw unknown_name(fmt::format("{}, at '/parts'", path), "part", name, known);
    const std::string code = fmt::format("{}{}{}", kFolder, name, kEnding);
    parts.push_back({code, std::string(embedded_text(code))});
  }
  return parts;
}

void check_solvers(const Catalog& catalog, const Choice& choice, std::string_view path) {
  if (!choice.is_solver) return;
  std::vector<std::string> known;
  for (const Solver& solver : catalog.solvers) known.push_back(solver.name);
  for (const std::string& name : choice.allowed)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw unknown_name(fmt::format("{}, at '/choices'", path), "solver", name, known);
}

void add_integrand(Catalog& catalog, const Json& classes, std::string_view path, const Json& entry,
                   SourceFile code) {
  Integrand integrand = read_integrand(entry, classes, path, std::move(code));
  for (const std::string& name : integrand.transforms) {
    std::vector<std::string> known;
    for (const Transform& t : catalog.transforms) known.push_back(t.name);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw unknown_name(fmt::format("{}, at '/transforms'", path), "transform", name, known);
  }
  for (const Choice& choice : integrand.choices) check_solvers(catalog, choice, path);
  integrand.parts = integrand_parts(entry, path);
  for (const Integrand& other : catalog.integrands) {
    if (other.name == integrand.name)
      throw InputError(fmt::format("{}, at '/name'", path),
                       fmt::format("the name '{}' exists already", other.name),
                       fmt::format("defined in {}", other.code.path));
  }
  catalog.integrands.push_back(std::move(integrand));
}

// A function that the entry promises and the code lacks is no matter for a compiler, which would
// name the harness's own pieces. Its name before a parenthesis will do.
void check_functions(const Integrand& f, const std::string& json_path) {
  using Kind = ExactSource::Kind;
  const std::string source = source_text(f);
  const auto require = [&](bool wanted, const char* name, const char* pointer, const char* says) {
    if (!wanted || std::regex_search(source, std::regex(fmt::format("\\b{}\\s*\\(", name)))) return;
    throw InputError(f.code.path, fmt::format("{} is missing", name),
                     fmt::format("{}, at '{}' says {}", json_path, pointer, says));
  };
  if (!std::regex_search(source, std::regex("\\bintegrand\\s*\\(")))
    throw InputError(f.code.path, "integrand is missing", "kernels/README.md has the contract");
  require(f.mean.kind == Kind::formula, "exact_mean", "/exact/mean", "formula");
  require(f.variance.kind == Kind::formula, "exact_variance", "/exact/variance", "formula");
  require(f.mean_abs.kind == Kind::formula, "exact_mean_abs", "/exact/mean_abs", "formula");
  require(f.variation.kind == Kind::formula, "exact_variation", "/exact/variation", "formula");
  require(f.discrete.kind == Kind::formula, "discrete_moments", "/exact/discrete", "formula");
  require(f.bound.kind == Kind::formula, "exact_bound", "/exact/bound", "formula");
  require(f.stiffness.kind == Kind::formula, "exact_stiffness", "/exact/stiffness", "formula");
  require(f.dimension_order, "dimension_order", "/dimension_order", "true");
  require(!f.coefficients.empty(), "integrand_setup", "/coefficients", "that there are some");
}

template <typename Entries>
auto& find_named(const Entries& entries, std::string_view kind, std::string_view name,
                 std::string_view where) {
  std::vector<std::string> known;
  for (const auto& entry : entries) {
    if (entry.name == name) return entry;
    known.push_back(entry.name);
  }
  throw unknown_name(where, kind, name, known);
}

}  // namespace

std::string_view entry_schema(std::string_view path) {
  if (path == kClassesPath) return "harness/catalog/classes.schema.json";
  if (path == kEstimatorsPath) return "harness/catalog/estimators.schema.json";
  if (is_json_in(path, "kernels/points/")) return "harness/catalog/points.schema.json";
  if (is_json_in(path, "kernels/points/vectors/")) return "harness/catalog/vectors.schema.json";
  if (is_json_in(path, "kernels/sums/")) return "harness/catalog/sum.schema.json";
  if (is_json_in(path, "kernels/solvers/")) return "harness/catalog/solver.schema.json";
  if (is_json_in(path, "kernels/transforms/") || is_json_in(path, "kernels/filters/"))
    return "harness/catalog/transform.schema.json";
  return path.starts_with("integrands/") && path.ends_with(".json") ? kIntegrandSchema : "";
}

Catalog load_catalog(const std::vector<std::string>& integrand_files) {
  Catalog catalog;
  const Json classes = embedded_entry(kClassesPath);
  const Json estimators = embedded_entry(kEstimatorsPath);
  for (const Json& entry : estimators["estimators"])
    catalog.estimators.push_back(read_estimator(entry));
  for (const EmbeddedFile& file : embedded_files()) read_kernels(catalog, file);
  for (const EmbeddedFile& file : embedded_files()) {
    if (entry_schema(file.path) == kIntegrandSchema)
      add_integrand(catalog, classes, file.path, embedded_entry(file.path),
                    embedded_code_beside(file.path));
  }
  for (const std::string& path : integrand_files) {
    if (!path.ends_with(".json"))
      throw InputError(fmt::format("--integrand {}", path), "the name does not end in .json",
                       "give the entry, F.json; its code F.cl lies beside it");
    const std::string code_path = std::filesystem::path(path).replace_extension(".cl").string();
    const Json entry = parse_json(read_text_file(path), path);
    check_schema(entry, kIntegrandSchema, path);
    add_integrand(catalog, classes, path, entry, {code_path, read_text_file(code_path)});
    catalog.integrands.back().users_own = true;
    check_functions(catalog.integrands.back(), path);
  }
  return catalog;
}

Sampler Catalog::sampler(std::string_view text, std::string_view where) const {
  const std::string_view name = text.substr(0, text.find(':'));
  Sampler result = find_named(samplers, "sampler", name, where);
  set_parameters(result, text.substr(name.size()), where);
  return result;
}
const Integrand& Catalog::integrand(std::string_view name, std::string_view where) const {
  return find_named(integrands, "integrand", name, where);
}
const SumAlgorithm& Catalog::sum(std::string_view name, std::string_view where) const {
  return find_named(sums, "sum", name, where);
}
const Estimator& Catalog::estimator(std::string_view name, std::string_view where) const {
  return find_named(estimators, "estimator", name, where);
}
const Family& Catalog::family(std::string_view name) const {
  return find_named(families, "family", name, "catalog");
}
const Solver& Catalog::solver(std::string_view name) const {
  return find_named(solvers, "solver", name, "catalog");
}
const Transform& Catalog::transform(std::string_view name) const {
  return find_named(transforms, "transform", name, "catalog");
}

const std::string* solver_of(const Integrand& integrand, const std::vector<std::string>& choices) {
  for (std::size_t i = 0; i < integrand.choices.size(); ++i)
    if (integrand.choices[i].is_solver) return &choices.at(i);
  return nullptr;
}

std::string source_text(const Integrand& integrand) {
  std::string text;
  for (const SourceFile& part : integrand.parts) text.append(part.text).append("\n");
  return text.append(integrand.code.text);
}

bool declares(const std::vector<std::string>& values, std::string_view value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

bool fits(const Estimator& estimator, const Sampler& sampler) {
  return estimator.fits.empty() ||
         std::any_of(estimator.fits.begin(), estimator.fits.end(),
                     [&](const auto& v) { return declares(sampler.validity, v); });
}

std::string rate_class(const Sampler& sampler, const Estimator& estimator) {
  return sampler.rate_class + estimator.rate_suffix;
}

std::vector<std::string> fitting_estimators(const Catalog& catalog, const Sampler& sampler) {
  std::vector<std::string> names;
  for (const Estimator& estimator : catalog.estimators)
    if (fits(estimator, sampler)) names.push_back(estimator.name);
  return names;
}

}  // namespace koksma
