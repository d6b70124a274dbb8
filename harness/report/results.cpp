#include "report/results.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <map>
#include <optional>

#include "catalog/embedded.hpp"
#include "journal/journal.hpp"
#include "report/build_info.hpp"

namespace koksma {
namespace {

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// N / (variance * seconds) of the largest N of an mc cell: the efficiency of plain Monte Carlo does
// not depend on N, and its exact variance is less noisy than its errors. Not of a cell that cannot
// reach that variance.
std::optional<double> mc_efficiency(const Json& cell) {
  if (cell["estimator"] != "mc" || cell["rows"].empty()) return std::nullopt;
  if (cell["stability"]["verdict"] == "UNRESOLVED") return std::nullopt;
  const Json& variance = cell["scene"]["exact"]["variance"]["value"];
  const double seconds = cell["rows"].back()["seconds_per_replicate"];
  if (!variance.is_number() || !(variance.get<double>() > 0) || !(seconds > 0)) return std::nullopt;
  return cell["rows"].back()["n"].get<double>() / (variance.get<double>() * seconds);
}

// Speed-up over plain Monte Carlo at equal error: the row's efficiency over that of the mc cell of
// the same scene, precision and sum.
void add_speed_ups(Json& cells) {
  const auto key = [](const Json& cell) {
    return cell["scene"]["text"].dump() + cell["precision"].dump() + cell["sum"].dump();
  };
  std::map<std::string, double> reference;
  for (const Json& cell : cells)
    if (const auto efficiency = mc_efficiency(cell)) reference[key(cell)] = *efficiency;
  for (Json& cell : cells) {
    const auto found = reference.find(key(cell));
    cell["efficiency"]["speed_up_over"] =
        found == reference.end()
            ? "no resolved cell of this scene has estimator mc and an exact variance"
            : "estimator mc at its largest N, by the exact variance";
    if (found == reference.end()) continue;
    for (Json& row : cell["rows"])
      if (row["efficiency"].is_number())
        row["speed_up"] = row["efficiency"].get<double>() / found->second;
  }
}

}  // namespace

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
  add_speed_ups(results["cells"]);
  return results;
}

void write_results(const Json& results, const std::string& path) {
  check_schema(results, "results/results.schema.json", path);
  write_file_atomically(path, dumped(results, 1) + "\n");
}

}  // namespace koksma
