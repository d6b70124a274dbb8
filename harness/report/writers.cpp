#include "report/writers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <utility>

#include "error/error.hpp"
#include "report/results.hpp"

namespace koksma {
namespace {

std::string row_name(const Json& cell, const Json& row) {
  return fmt::format("{}/n:{}", cell_name(cell, '/'), row["n"].get<std::uint64_t>());
}

Json benchmark_entry(const std::string& name, std::size_t family) {
  return {{"name", name},
          {"family_index", family},
          {"per_family_instance_index", 0},
          {"run_name", name},
          {"run_type", "iteration"},
          {"repetitions", 1},
          {"repetition_index", 0},
          {"threads", 1}};
}

Json benchmark_of_row(const Json& cell, const Json& row, std::size_t family, std::size_t place) {
  Json entry = benchmark_entry(row_name(cell, row), family);
  entry["per_family_instance_index"] = place;
  entry["iterations"] = row["kernel_s"]["count"].get<std::uint64_t>() *
                        row.value("runs_per_launch", std::uint64_t{1});
  entry["real_time"] = row["kernel_s"]["median"].get<double>() * 1e9;
  entry["cpu_time"] = row["wall_s"]["median"].get<double>() * 1e9;
  entry["time_unit"] = "ns";
  for (const auto& [counter, key] : {std::pair{"items_per_second", "samples_per_s"},
                                     {"coordinates_per_second", "coordinates_per_s"},
                                     {"estimate", "estimate"},
                                     {"rmse", "rmse"},
                                     {"median_abs_error", "median_abs_error"},
                                     {"efficiency", "efficiency"},
                                     {"nonfinite", "nonfinite"}})
    if (row[key].is_number()) entry[counter] = row[key];
  entry["replicates"] = cell["replicates"];
  return entry;
}

Json half_range(const Json& interval) {
  if (!interval.is_array() || !interval[0].is_number() || !interval[1].is_number()) return nullptr;
  return (interval[1].get<double>() - interval[0].get<double>()) / 2;
}

Json chart_entry(const std::string& name, const char* unit, double value, const Json& half,
                 const std::string& extra) {
  Json entry = {{"name", name}, {"unit", unit}, {"value", value}};
  if (half.is_number()) entry["range"] = fmt::format("± {:.3g}", half.get<double>());
  entry["extra"] = extra;
  return entry;
}

using Writer = Json (*)(const Json& results);
constexpr std::array<std::pair<const char*, Writer>, 2> kWriters{
    {{"google-benchmark", google_benchmark_json}, {"chart", chart_json}}};

}  // namespace

Json google_benchmark_json(const Json& results) {
  const Json& from = results["context"];
  Json json;
  json["context"] = {{"date", from["date"]},
                     {"host_name", from["host"]},
                     {"executable", "koksma"},
                     {"num_cpus", from["device"]["compute_units"]},
                     {"mhz_per_cpu", 0},  // not known of an OpenCL device
                     {"cpu_scaling_enabled", false},
                     {"caches", Json::array()},
                     {"load_avg", Json::array()},
                     {"library_build_type", from["build_type"] == "Debug" ? "debug" : "release"},
                     {"json_schema_version", 1}};
  for (const char* key : {"version", "revision", "command"})
    json["context"][fmt::format("koksma_{}", key)] = from[key];
  for (const char* key : {"name", "platform", "driver"})
    json["context"][fmt::format("device_{}", key)] = from["device"][key];
  json["benchmarks"] = Json::array();
  std::size_t family = 0;
  for (const Json& cell : results["cells"]) {
    std::size_t place = 0;
    for (const Json& row : cell["rows"])
      json["benchmarks"].push_back(benchmark_of_row(cell, row, family, place++));
    if (cell["status"] != "ok") {
      Json entry = benchmark_entry(cell_name(cell, '/'), family);
      entry["error_occurred"] = true;
      entry["error_message"] = fmt::format("{}: {}", cell["status"].get<std::string>(),
                                           cell["reason"].get<std::string>());
      entry["iterations"] = 0;
      entry["real_time"] = entry["cpu_time"] = 0;
      entry["time_unit"] = "ns";
      json["benchmarks"].push_back(std::move(entry));
    }
    ++family;
  }
  return json;
}

Json chart_json(const Json& results) {
  Json json = Json::array();
  for (const Json& cell : results["cells"]) {
    for (const Json& row : cell["rows"]) {
      const std::string name = row_name(cell, row);
      const std::string extra =
          fmt::format("R = {}, {} launches, {}", cell["replicates"].get<std::uint64_t>(),
                      row["kernel_s"]["count"].get<std::uint64_t>(),
                      results["context"]["device"]["name"].get<std::string>());
      json.push_back(chart_entry(name + " time", "us",
                                 row["kernel_s"]["median"].get<double>() * 1e6,
                                 row["kernel_s"]["spread"].get<double>() / 2 * 1e6, extra));
      if (row["rmse"].is_number())
        json.push_back(chart_entry(name + " RMSE", "RMSE", row["rmse"],
                                   half_range(row["rmse_interval"]), extra));
    }
  }
  return json;
}

std::vector<std::string> report_formats() {
  std::vector<std::string> names;
  for (const auto& [name, writer] : kWriters) names.emplace_back(name);
  return names;
}

std::string report_text(const Json& results, const std::string& format) {
  for (const auto& [name, writer] : kWriters)
    if (format == name) return dumped(writer(results), 2) + "\n";
  if (format.empty())
    throw InputError("--format", "no format is given, and there is no HTML yet",
                     fmt::format("give {}", fmt::join(report_formats(), " or ")));
  throw unknown_name("--format", "format", format, report_formats());
}

}  // namespace koksma
