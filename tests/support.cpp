#include "support.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "catalog/json.hpp"
#include "catalog/sizes.hpp"

namespace koksma::test {

const Catalog& catalog() {
  static const Catalog loaded = load_catalog();
  return loaded;
}

Device& device() {
  static Device chosen = Device::choose("");
  return chosen;
}

std::vector<double> points(const PointsSpec& spec) {
  const Sampler sampler = catalog().sampler(spec.sampler, "test");
  std::uint64_t end = spec.start + spec.count;
  if (!sampler.extensible) end = spec.n > 0 ? spec.n : admitted_size(sampler, spec.dim, end);
  Plan plan = make_points_plan(catalog(), spec.sampler, spec.dim, spec.precision, end,
                               spec.replicate + 1, spec.seed, device().facts(), "",
                               LaunchShape{spec.lanes_per_item, 1, {}, {}});
  PointsDump dump(device(), plan);
  return dump.read(spec.start, spec.count, end, spec.replicate, spec.log2_block);
}

bool has_property(const Sampler& sampler, std::string_view property) {
  return declares(sampler.properties, property);
}

bool complete(const Sampler& sampler) {
  return std::none_of(sampler.parameters.begin(), sampler.parameters.end(),
                      [](const SamplerParameter& p) { return p.required; });
}

std::vector<Precision> precisions(const Sampler& sampler) {
  std::vector<Precision> result;
  for (const std::string& name : sampler.precisions)
    result.push_back(name == "fp32" ? Precision::fp32 : Precision::fp64);
  return result;
}

std::vector<std::uint32_t> some_replicates(const Sampler& sampler) {
  return sampler.replicable ? std::vector<std::uint32_t>{0, 1, 2, 3}
                            : std::vector<std::uint32_t>{0};
}

std::uint32_t usual_dim(const Sampler& sampler) {
  return std::clamp(5U, sampler.min_dim, sampler.max_dim);
}

std::vector<Sampler> samplers_by_kernel() {
  std::vector<Sampler> result;
  std::set<std::string> seen;
  for (const Sampler& s : catalog().samplers) {
    if (!complete(s)) continue;
    const std::uint32_t dim = usual_dim(s);
    const Plan plan = make_points_plan(catalog(), s.name, dim, Precision::fp64,
                                       admitted_size(s, dim, 256), 1, 1, device().facts());
    if (seen.insert(plan.program.text).second) result.push_back(s);
  }
  return result;
}

std::uint64_t grid_size(const Sampler& sampler, std::uint32_t dim) {
  const std::uint32_t power = 14 / dim * dim;
  const std::uint32_t log2_n = sampler.size_form == "power-of-d"         ? power
                               : sampler.size_form == "twice-power-of-d" ? power + 1
                                                                         : 14;
  return std::uint64_t{1} << std::min(log2_n, sampler.max_log2_n);
}

std::uint64_t admitted_size(const Sampler& sampler, std::uint32_t dim, std::uint64_t at_least) {
  const auto size = nearest_sizes(sampler, dim, at_least).above;
  if (!size) throw std::runtime_error("no such size of " + sampler.name);
  return *size;
}

Cell cell(const std::string& scene, const std::string& sampler, std::uint64_t n,
          std::uint32_t replicates, const std::string& estimator) {
  Cell result;
  result.scene = parse_scene(catalog(), scene, "test");
  result.sampler = sampler;
  result.estimator =
      estimator.empty() ? catalog().sampler(sampler, "test").default_estimator : estimator;
  result.n = {n};
  result.replicates = replicates;
  result.seed = 1;
  return result;
}

CellResult run_sizes(const std::string& scene, const std::string& sampler, const std::string& sizes,
                     std::uint32_t replicates, std::optional<Precision> precision) {
  Cell sized = cell(scene, sampler, 256, replicates);
  sized.n = parse_sizes(sizes, "test");
  sized.precision = precision;
  sized.launches = 1;  // errors are looked at, not times
  return PreparedCell(catalog(), device(), device(), make_plan(catalog(), sized, device().facts()))
      .run();
}

std::vector<double> partial_sums(const Cell& cell, const LaunchShape& shape) {
  const Plan plan = make_plan(catalog(), cell, device().facts(), "", {shape});
  const ExactValues exact = compute_exact(device(), *plan.integrand, cell.scene);
  Integrator integrator(device(), plan, exact.coefficients);
  // A launch split hands out pieces; [word][replicate] puts them back in the device's order.
  std::vector<std::vector<double>> pieces(std::size_t{plan.words()} * cell.replicates);
  integrator.run(cell.n.back(), 0.25,
                 [&](std::uint32_t word, std::uint32_t r, std::span<const double> partials) {
                   auto& piece = pieces[std::size_t{word} * cell.replicates + r];
                   piece.insert(piece.end(), partials.begin(), partials.end());
                 });
  std::vector<double> all;
  for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

CommandResult run_command(const std::string& arguments, const std::string& environment) {
  const std::string line = environment + " " KOKSMA_COMMAND " " + arguments + " 2>&1 </dev/null";
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("popen failed");
  CommandResult result;
  std::array<char, 4096> buffer{};
  while (const std::size_t got = fread(buffer.data(), 1, buffer.size(), pipe))
    result.output.append(buffer.data(), got);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "koksma-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path(name), std::ios::binary) << text;
  return path(name);
}

RunResult run_study(const TemporaryFolder& folder, const std::string& arguments,
                    const std::string& name) {
  RunResult result{run_command("run " + arguments + " --out " + folder.path(name)), {}};
  INFO(result.command.output);
  REQUIRE(std::filesystem::exists(folder.path(name)));
  result.results = Json::parse(read_text_file(folder.path(name)));
  check_schema(result.results, "results/results.schema.json", name);
  return result;
}

EnvironmentSet::EnvironmentSet(const char* name, const std::string& value) : name_(name) {
  if (const char* before = std::getenv(name)) before_ = before;
  setenv(name, value.c_str(), 1);
}

EnvironmentSet::~EnvironmentSet() {
  if (before_)
    setenv(name_, before_->c_str(), 1);
  else
    unsetenv(name_);
}

std::string repository_file(const std::string& path) {
  return read_text_file(std::filesystem::path(KOKSMA_SOURCE_DIR) / path);
}

const Json& recorded_study() {
  static const Json kept = [] {
    Json results = parse_json(repository_file("results/default-study.json"), "recorded");
    Json cells = Json::array();
    for (std::size_t i = 0; i < 5; ++i) cells.push_back(results["cells"][i]);
    results["cells"] = cells;
    return results;
  }();
  return kept;
}

}  // namespace koksma::test
