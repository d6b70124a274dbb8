#include "cli/input_files.hpp"

#include <algorithm>
#include <filesystem>

#include "error/error.hpp"
#include "points/matrices.hpp"

namespace koksma {

Json input_files(const Catalog& catalog, const Study& study,
                 const std::vector<std::string>& integrands, const std::string& directions) {
  std::vector<std::string> paths;
  for (const Cell& cell : study.cells) {
    const Sampler sampler = catalog.sampler(cell.sampler, "sampler");
    for (const SamplerParameter& p : sampler.parameters)
      if (p.path && sampler.options.contains(p.name)) paths.push_back(sampler.options[p.name]);
  }
  for (const std::string& path : integrands) {
    paths.push_back(path);
    paths.push_back(std::filesystem::path(path).replace_extension(".cl").string());
  }
  if (!directions.empty()) paths.push_back(directions);
  Json files;
  for (const std::string& path : paths)
    files[path] = std::hash<std::string>{}(read_text_file(path));
  return files;
}

void check_directions(const Catalog& catalog, const Study& study, const std::string& directions) {
  std::uint32_t most = 0;
  for (const Cell& cell : study.cells)
    if (catalog.sampler(cell.sampler, "sampler").reads_directions)
      most = std::max(most, cell.scene.dim);
  if (directions.empty()) return;
  if (most == 0)
    throw InputError("--directions", "no sampler of the study reads direction numbers",
                     "leave the flag out");
  sobol_matrices_from_file(directions, most, 1);
}

void check_sampler_files(const Catalog& catalog, const Study& study, const DeviceFacts& device) {
  for (const Cell& cell : study.cells) {
    const Sampler sampler = catalog.sampler(cell.sampler, "sampler");
    if (std::none_of(sampler.parameters.begin(), sampler.parameters.end(),
                     [](const SamplerParameter& p) { return p.path; }))
      continue;
    try {
      make_plan(catalog, cell, device);
    } catch (const UnsupportedError&) {  // a row of the results will tell
    }
  }
}

}  // namespace koksma
