#include "report/stability_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "report/results.hpp"
#include "report/text_table.hpp"

namespace koksma {
namespace {

constexpr const char* kSchema = "results/stability.schema.json";

Json range_json(const std::optional<Interval>& range) {
  return range ? Json{range->low, range->high} : Json(nullptr);
}

Json demand_json(const std::optional<Demand>& demand) {
  if (!demand) return nullptr;
  return {{"verdict", demand->verdict},           {"overflow", demand->overflow},
          {"held_by", demand->held_by},           {"bias", range_json(demand->bias)},
          {"digits", range_json(demand->digits)}, {"note", demand->note}};
}

Json relaxed_json(const std::optional<RelaxedDifference>& relaxed) {
  if (!relaxed) return nullptr;
  return {{"reason", relaxed->reason},
          {"difference", number_or_null(relaxed->difference)},
          {"in_rmse", number_or_null(relaxed->in_rmse)}};
}

Json case_json(const CaseOutcome& outcome) {
  return {{"cell", outcome.cell},
          {"demand", demand_json(outcome.demand)},
          {"met", outcome.demand ? Json(outcome.faults.empty()) : Json(nullptr)},
          {"faults", outcome.faults},
          {"digits", number_or_null(outcome.digits)},
          {"floor",
           {{"predicted", number_or_null(outcome.floor_predicted)},
            {"bound", number_or_null(outcome.floor_bound)},
            {"seen", number_or_null(outcome.floor_seen)}}},
          {"dominates", outcome.dominates},
          {"relaxed", relaxed_json(outcome.relaxed)}};
}

std::vector<std::string> case_columns(const Json& item, bool with_relaxed) {
  const Json& cell = item["cell"];
  const Json& verdict = cell["stability"]["verdict"];
  std::string word = (verdict.is_string() ? verdict : cell["status"]).get<std::string>();
  for (const Json& mark : cell["stability"]["marks"]) word += " +" + mark.get<std::string>();
  std::vector<std::string> columns{
      item["met"] == false ? "!" : "",
      cell["scene"]["text"],
      cell["sampler"],
      cell["precision"].is_string() ? cell["precision"].get<std::string>() : "-",
      cell["sum"],
      word,
      number_text(item["digits"], "{:.1f}"),
      number_text(item["floor"]["predicted"], "{:.1e}"),
      number_text(item["floor"]["seen"], "{:.1e}")};
  if (with_relaxed)
    columns.push_back(
        item["relaxed"].is_object() ? number_text(item["relaxed"]["in_rmse"], "{:.1e}") : "-");
  columns.push_back(item["dominates"]);
  return columns;
}

constexpr const char* kStabilityLegend =
    "digits: -log10 of the relative RMSE at the largest N. floor: the level below which the error "
    "does not fall, as\nestimated and as seen where the curve ends on it. dominates: what the "
    "error "
    "at the largest N is. !: not the verdict,\nbias or digits that the case must show. `stability` "
    "in the file says why for each.\n";

std::string faults_text(const Json& json) {
  std::string text;
  for (const Json& item : json["cases"]) {
    const Json& faults = item["faults"];
    for (const Json& fault : faults)
      text += fmt::format(
          "! {} with {} in {}: {}\n", item["cell"]["scene"]["text"].get<std::string>(),
          item["cell"]["sampler"].get<std::string>(),
          item["cell"]["precision"].is_string() ? item["cell"]["precision"].get<std::string>()
                                                : "-",
          fault.get<std::string>());
  }
  return text;
}

std::string floors_text(const Json& floors) {
  std::string text =
      fmt::format("Floors: {} cases end on one; the estimate is within a factor 10 of {}.\n",
                  floors["reached"].get<std::size_t>(), floors["within_ten"].get<std::size_t>());
  const Json& exceptions = floors["exceptions"];
  for (const Json& exception : exceptions)
    text += fmt::format("  not of {}\n", exception.get<std::string>());
  return text;
}

// "intact", or what breaks, by option set and precision.
std::string eft_text(const Json& eft) {
  std::string text = "Error-free transformations:\n";
  const Json& sets = eft["option_sets"];
  for (const Json& set : sets) {
    const std::string options = set["options"].get<std::string>();
    text += fmt::format("  {} {:32} {}", set["precision"].get<std::string>(),
                        options.empty() ? "strict" : options, set["selftest"].get<std::string>());
    const Json& failed = set["failed"];
    if (!failed.empty()) text += ": " + failed[0]["what"].get<std::string>();
    text += "\n";
  }
  return text;
}

std::string summation_text(const Json& summation) {
  std::vector<std::vector<std::string>> lines{{"terms", "n per lane"}};
  const Json& rows = summation["rows"];
  if (rows.empty()) return "";
  for (const auto& [name, entry] : rows[0]["sums"].items()) lines[0].push_back(name);
  for (const Json& row : rows) {
    std::vector<std::string> line{row["terms"],
                                  fmt::format("{}", row["n_per_lane"].get<std::uint64_t>())};
    for (const std::string& name : std::vector<std::string>(lines[0].begin() + 2, lines[0].end()))
      line.push_back(row["sums"].contains(name) ? number_text(row["sums"][name]["error"], "{:.1e}")
                                                : "-");
    lines.push_back(std::move(line));
  }
  return fmt::format("Relative error of sums of {} terms, one accumulator per lane:\n{}",
                     summation["precision"].get<std::string>(), text_table(lines));
}

std::string invariance_text(const Json& invariance) {
  std::vector<std::vector<std::string>> lines{
      {"sum", "distinct results", "of one block length", "relative spread"}};
  const Json& sums = invariance["sums"];
  for (const auto& [name, entry] : sums.items())
    lines.push_back(
        {name, fmt::format("{}", entry["distinct_sums"].get<std::size_t>()),
         fmt::format("{}", entry["distinct_sums_of_one_block_length"].get<std::size_t>()),
         number_text(entry["spread"], "{:.1e}")});
  return fmt::format("{} launch shapes, {}, N = {}:\n{}",
                     invariance["launch_shapes"].get<std::size_t>(),
                     invariance["precision"].get<std::string>(),
                     invariance["n"].get<std::uint64_t>(), text_table(lines));
}

std::string device_checks_text(const Json& checks) {
  std::string text = eft_text(checks["eft"]) + "\n" + summation_text(checks["summation"]) + "\n" +
                     invariance_text(checks["invariance"]) + "\n";
  for (const char* name : {"eft", "summation", "invariance", "indices", "denormals"}) {
    const Json& why = checks[name]["why"];
    text += fmt::format("{:10} {}\n", name,
                        checks[name]["ok"] == true ? "ok" : "FAILED: " + why.get<std::string>());
  }
  return text;
}

}  // namespace

Json stability_json(const Json& context, const DeviceChecks& checks,
                    const std::vector<CaseOutcome>& outcomes, double seconds) {
  Json json;
  json["schema_version"] = kStabilitySchemaVersion;
  json["context"] = context;
  json["device_checks"] = to_json(checks);
  json["cases"] = Json::array();
  Json cells = Json::array();
  for (const CaseOutcome& outcome : outcomes) {
    json["cases"].push_back(case_json(outcome));
    cells.push_back(outcome.cell);
  }
  const FloorComparison floors = compare_floors(outcomes);
  json["floors"] = {{"reached", floors.reached},
                    {"within_ten", floors.within_ten},
                    {"exceptions", floors.exceptions}};
  json["seconds"] = seconds;
  check_schema(json, kSchema, "koksma stability");
  check_schema(make_results(context, cells), "results/results.schema.json", "koksma stability");
  return json;
}

std::string stability_table(const Json& json) {
  const Json& cases = json["cases"];
  const bool with_relaxed = std::any_of(cases.begin(), cases.end(),
                                        [](const Json& c) { return c["relaxed"].is_object(); });
  std::vector<std::vector<std::string>> lines{
      {"", "case", "sampler", "prec", "sum", "verdict", "digits", "floor", "seen"}};
  if (with_relaxed) lines[0].push_back("fast/RMSE");
  lines[0].push_back("dominates");
  std::size_t met = 0, demanded = 0;
  std::map<std::string, std::size_t> untried;  // by reason
  for (const Json& item : cases) {
    if (item["met"].is_null() && item["cell"]["status"] == "unsupported")
      ++untried[item["cell"]["reason"]];
    lines.push_back(case_columns(item, with_relaxed));
    demanded += item["met"].is_boolean() ? 1 : 0;
    met += item["met"] == true ? 1 : 0;
  }
  std::string text = text_table(lines) + "\n" + kStabilityLegend + "\n" + faults_text(json);
  if (demanded > 0) text += fmt::format("{} of {} cases show what they must.\n", met, demanded);
  for (const auto& [reason, count] : untried)
    text += fmt::format("not tried, unsupported, {}: {}\n", count, reason);
  text += floors_text(json["floors"]);
  return text + "\n" + device_checks_text(json["device_checks"]) +
         fmt::format("\n{:.0f} s\n", json["seconds"].get<double>());
}

bool all_met(const Json& json) {
  const Json& cases = json["cases"];
  return json["device_checks"]["ok"] == true &&
         std::none_of(cases.begin(), cases.end(), [](const Json& c) {
           return c["met"] == false || c["cell"]["status"] == "failed";
         });
}

}  // namespace koksma
