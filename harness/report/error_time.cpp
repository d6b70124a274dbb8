#include "report/error_time.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "estimate/efficiency.hpp"
#include "estimate/pareto.hpp"

namespace koksma {
namespace {

constexpr const char* kNoRandom =
    "no resolved cell of this scene and precision has estimator mc, and a known variance or a rate";
constexpr const char* kIsRandom = "this is that cell";

std::optional<double> number_of(const Json& value) {
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

// Samples of one estimate per n: a median takes several randomizations.
double randomizations(const Json& cell) {
  return cell["plan"].is_object() ? cell["plan"]["replicates_per_estimate"].get<double>() : 1;
}

bool believed(const Json& row) {
  return row["rmse"].is_number() && row["rmse_interval_method"] != "unresolved" &&
         row["below_reference"] == false;
}

// Plain Monte Carlo on one scene: its error by N, its time by N.
struct Random {
  std::size_t cell = 0;
  std::string sum;
  std::optional<double> variance;
  std::optional<ErrorLine> line;
  TimeLine times;
  double efficiency = 0;  // 1/(MSE·time), which does not depend on N: of its largest N

  double error(double n) const { return variance ? std::sqrt(*variance / n) : error_at(*line, n); }
  double samples_to(double error) const {
    return variance ? *variance / (error * error)
                    : std::exp2((std::log2(error) - line->intercept) / line->slope);
  }
};

std::optional<TimeLine> time_line(const Json& cell) {
  const Json& json = cell["efficiency"]["time_line"];
  if (!json.is_object()) return std::nullopt;
  return TimeLine{json["overhead_s"], json["seconds_per_sample"], json["rows"],
                  json["largest_deviation"]};
}

std::optional<ErrorLine> error_line(const Json& cell) {
  const Json& fit = cell["convergence"];
  if (!fit["rate"].is_number() || !(fit["rate"].get<double>() < 0)) return std::nullopt;
  return ErrorLine{fit["rate"], fit["intercept"], 0, 0};
}

// Its exact variance is less noisy than its errors. None of a cell that cannot reach that variance.
std::optional<Random> random_of(const Json& cell, std::size_t index) {
  if (cell["estimator"] != "mc" || cell["rows"].empty()) return std::nullopt;
  if (cell["stability"]["verdict"] == "UNRESOLVED") return std::nullopt;
  const std::optional<TimeLine> times = time_line(cell);
  const std::optional<double> seconds = number_of(cell["rows"].back()["seconds_per_replicate"]);
  if (!times || !seconds || !(*seconds > 0)) return std::nullopt;
  Random random{index, cell["sum"], number_of(cell["scene"]["exact"]["variance"]["value"]),
                error_line(cell), *times};
  if (random.variance && !(*random.variance > 0)) random.variance.reset();
  if (!random.variance && !random.line) return std::nullopt;
  const double error = random.error(cell["rows"].back()["n"].get<double>());
  random.efficiency = 1 / (error * error * *seconds);
  return random;
}

using Randoms = std::map<std::string, std::vector<Random>>;

std::string place_of(const Json& cell) {
  return cell["scene"]["text"].dump() + cell["precision"].dump();
}

Randoms find_randoms(const Json& cells) {
  Randoms randoms;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (auto random = random_of(cells[i], i)) randoms[place_of(cells[i])].push_back(*random);
  return randoms;
}

// The first with the cell's sum, else the first.
const Random* random_for(const Randoms& randoms, const Json& cell) {
  const auto found = randoms.find(place_of(cell));
  if (found == randoms.end()) return nullptr;
  for (const Random& random : found->second)
    if (cell["sum"] == random.sum) return &random;
  return &found->second.front();
}

void refuse(Json& efficiency, const char* reason) {
  efficiency["speed_up_over"] = {{"cell", nullptr}, {"error_by", nullptr}, {"reason", reason}};
  for (Json& t : efficiency["time_to_tolerance"]) {
    t["speed_up"] = nullptr;
    t["speed_up_reason"] = reason;
  }
  for (const char* at : {"equal_n", "equal_time"})
    efficiency["crossover"][at] = {{"n", nullptr}, {"reason", reason}};
}

void compare_tolerances(const Random& random, Json& efficiency) {
  for (Json& t : efficiency["time_to_tolerance"]) {
    t["speed_up"] = nullptr;
    if (!t["seconds"].is_number()) {
      t["speed_up_reason"] = "the cell has no time to it";
      continue;
    }
    const double n =
        random.samples_to(t["tolerance"].get<double>() * efficiency["relative_to"].get<double>());
    const double ratio = seconds_at(random.times, n) / t["seconds"].get<double>();
    const bool said = n >= 1 && std::isfinite(ratio) && ratio > 0;
    if (said) t["speed_up"] = ratio;
    t["speed_up_reason"] = said ? "" : n < 1 ? "one random sample meets it" : "not finite";
  }
}

// The upper end of the 95 % interval, where there is one: a gain that may be chance is none.
double error_for_sure(const Json& row) {
  const Json& interval = row["rmse_interval"];
  if (interval.is_array() && interval[1].is_number()) return interval[1];
  return row["rmse"];
}

Json crossover_json(const std::vector<BesideRandom>& rows) {
  if (rows.empty()) return {{"n", nullptr}, {"reason", "no row has an RMSE to compare"}};
  const std::optional<std::uint64_t> n = crossover(rows);
  if (!n) return {{"n", nullptr}, {"reason", "the last row is not below it for sure"}};
  return {{"n", *n}, {"reason", ""}};
}

void compare_rows(const Random& random, Json& cell) {
  const std::optional<TimeLine> times = time_line(cell);
  std::vector<BesideRandom> equal_n, equal_time;
  for (Json& row : cell["rows"]) {
    row["speed_up"] = nullptr;
    if (row["efficiency"].is_number())
      row["speed_up"] = row["efficiency"].get<double>() / random.efficiency;
    if (!believed(row)) continue;
    const std::uint64_t n = row["n"];
    const double samples = static_cast<double>(n) * randomizations(cell);
    equal_n.push_back({n, error_for_sure(row), random.error(samples)});
    if (!times) continue;
    const double paid = samples_in(random.times, seconds_at(*times, static_cast<double>(n)));
    equal_time.push_back({n, error_for_sure(row), random.error(std::max(paid, 1.0))});
  }
  cell["efficiency"]["crossover"] = {{"equal_n", crossover_json(equal_n)},
                                     {"equal_time", crossover_json(equal_time)}};
}

struct Candidate {
  std::size_t cell, row;
};

Json front_json(const Json& cells, const std::vector<Candidate>& candidates) {
  std::vector<ErrorTime> points;
  for (const Candidate& c : candidates) {
    const Json& row = cells[c.cell]["rows"][c.row];
    points.push_back({row["seconds_per_replicate"], row["rmse"]});
  }
  Json front = Json::array();
  for (const std::size_t i : pareto_front(points)) {
    const Json& cell = cells[candidates[i].cell];
    front.push_back({{"cell", candidates[i].cell},
                     {"sampler", cell["sampler"]},
                     {"estimator", cell["estimator"]},
                     {"precision", cell["precision"]},
                     {"replicates", cell["replicates"]},
                     {"n", cell["rows"][candidates[i].row]["n"]},
                     {"seconds", points[i].seconds},
                     {"rmse", points[i].error}});
  }
  return front;
}

}  // namespace

void compare_with_random(Json& cells) {
  const Randoms randoms = find_randoms(cells);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Json& cell = cells[i];
    const Random* random = random_for(randoms, cell);
    if (random == nullptr) {
      refuse(cell["efficiency"], kNoRandom);
      for (Json& row : cell["rows"]) row["speed_up"] = nullptr;
      continue;
    }
    cell["efficiency"]["speed_up_over"] = {
        {"cell", random->cell},
        {"error_by", random->variance ? "exact variance" : "fitted line"},
        {"reason", ""}};
    compare_tolerances(*random, cell["efficiency"]);
    compare_rows(*random, cell);
    if (random->cell == i)
      for (const char* at : {"equal_n", "equal_time"})
        cell["efficiency"]["crossover"][at] = {{"n", nullptr}, {"reason", kIsRandom}};
  }
}

Json scenes_of(const Json& cells) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<Candidate>> all, replicated;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string scene = cells[i]["scene"]["text"];
    if (all.try_emplace(scene).second) order.push_back(scene);
    for (std::size_t r = 0; r < cells[i]["rows"].size(); ++r) {
      const Json& row = cells[i]["rows"][r];
      if (!believed(row) || !(row["seconds_per_replicate"].get<double>() > 0)) continue;
      all[scene].push_back({i, r});
      if (cells[i]["replicates"].get<std::uint32_t>() > 1) replicated[scene].push_back({i, r});
    }
  }
  Json scenes = Json::array();
  for (const std::string& scene : order)
    scenes.push_back(
        {{"scene", scene},
         {"points", all[scene].size()},
         {"front", front_json(cells, all[scene])},
         {"front_replicated", front_json(cells, replicated[scene])},
         {"reason", all[scene].empty() ? "no row has a resolved RMSE and a time" : ""}});
  return scenes;
}

}  // namespace koksma
