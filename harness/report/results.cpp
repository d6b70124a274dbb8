#include "report/results.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "catalog/embedded.hpp"
#include "catalog/utc.hpp"
#include "journal/journal.hpp"
#include "report/build_info.hpp"
#include "report/error_time.hpp"

namespace koksma {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

}  // namespace

std::string cell_name(const Json& cell, char between) {
  const std::string precision = cell["precision"].is_string() ? cell["precision"] : Json("-");
  return fmt::format("{1}{0}{2}{0}{3}{0}{4}{0}{5}", between,
                     cell["scene"]["text"].get<std::string>(), cell["sampler"].get<std::string>(),
                     cell["estimator"].get<std::string>(), precision,
                     cell["sum"].get<std::string>());
}

Json make_context(const DeviceFacts& device, const Study& study, const std::string& command_line) {
  const BuildInfo build = build_info();
  Json context;
  context["version"] = build.version;
  context["revision"] = build.revision;
  context["build_type"] = build.build_type;
  context["compiler"] = build.compiler;
  context["date"] = utc_now();
  context["host"] = host_name();
  context["command"] = command_line;
  context["device"] = {{"name", device.name},         {"vendor", device.vendor},
                       {"platform", device.platform}, {"driver", device.driver},
                       {"version", device.version},   {"cpu", device.is_cpu},
                       {"fp64", device.fp64},         {"compute_units", device.compute_units}};
  context["environment"] = Json::object();
  for (const char* name : {"POCL_AFFINITY", "POCL_MAX_PTHREAD_COUNT", "OCL_ICD_VENDORS"})
    if (const char* value = std::getenv(name)) context["environment"][name] = value;
  context["seed"] = study.seed;
  context["study"] = study.verbatim;
  return context;
}

Json resume_context(const Json& context) {
  Json result;
  for (const char* key : {"version", "revision", "build_type", "compiler", "device", "environment"})
    result[key] = context[key];
  // Uncommitted kernels have no revision of their own.
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a
  for (const EmbeddedFile& file : embedded_files())
    for (const char c : file.text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  result["catalog"] = hash;
  return result;
}

Json make_results(const Json& context, const Json& cells) {
  Json results;
  results["schema_version"] = kResultsSchemaVersion;
  results["context"] = context;
  results["cells"] = cells;
  compare_with_random(results["cells"]);
  results["scenes"] = scenes_of(results["cells"]);
  return results;
}

void write_results(const Json& results, const std::string& path) {
  check_schema(results, "results/results.schema.json", path);
  write_file_atomically(path, dumped(results, 1) + "\n");
}

}  // namespace koksma
