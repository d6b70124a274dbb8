#include "journal/efficiency_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "estimate/efficiency.hpp"
#include "journal/cell_json.hpp"

namespace koksma {
namespace {

constexpr const char* kSeenLater = "the other cells of the run were not looked at";

// |I|, or 1 where I = 0 or is not known: what tolerances are multiplied by.
std::optional<double> truth_of(const CellResult& result) {
  if (result.exact.mean) return result.exact.mean;
  return result.reference ? std::optional(result.reference->value) : std::nullopt;
}

std::optional<TimeLine> times_of(const CellResult& result) {
  std::vector<Timing> timings;
  for (const Row& row : result.rows)
    timings.push_back({row.n, row.kernel.median / result.cell.replicates});
  return fit_times(timings);
}

// Errors are not followed below three floors, where a fit leaves rows out, nor below a flat end.
void take_level(const CellResult& result, CurveFacts& curve) {
  if (std::isfinite(result.floor)) curve.level = kFloorFactor * result.floor;
  curve.level_is = "3 times the estimated floor";
  const Plateau& plateau = result.rate.plateau;
  if (plateau.kind == PlateauKind::none || !(plateau.level > curve.level)) return;
  curve.level = plateau.level;
  curve.level_is = "where the errors end flat";
}

CurveFacts curve_of(const CellResult& result, unsigned max_log2_n) {
  const RateFit& rate = result.rate;
  CurveFacts curve;
  curve.times = times_of(result);
  curve.most_n = std::uint64_t{1} << max_log2_n;
  if (rate.slope && rate.intercept && !rate.used.empty())
    curve.errors = ErrorLine{*rate.slope, *rate.intercept, rate.used.front(), rate.used.back()};
  curve.no_errors = rate.reason.empty() ? "there is no rate of the RMSE" : rate.reason;
  take_level(result, curve);
  return curve;
}

Json times_json(const std::optional<TimeLine>& times) {
  if (!times) return nullptr;
  return {{"overhead_s", times->overhead},
          {"seconds_per_sample", times->per_sample},
          {"rows", times->rows},
          {"largest_deviation", times->largest_deviation}};
}

Json tolerance_json(const CurveFacts& curve, int digits, const std::optional<double>& truth) {
  const double tolerance = std::stod(fmt::format("1e-{}", digits));
  ToTolerance t;
  if (truth)
    t = to_tolerance(curve, tolerance * (*truth != 0 ? std::fabs(*truth) : 1));
  else
    t.reason = "there is nothing that errors are against";
  return {{"tolerance", tolerance},
          {"n", number_or_null(t.n)},
          {"seconds", number_or_null(t.seconds)},
          {"extrapolated", t.extrapolated},
          {"octaves_beyond", t.octaves_beyond},
          {"reason", t.reason},
          {"speed_up", nullptr},
          {"speed_up_reason", kSeenLater}};
}

// That of the largest N.
void add_value(const Json& cell, Json& json) {
  json["value"] = json["at_n"] = nullptr;
  json["reason"] = "the cell did not run";
  if (cell["rows"].empty()) return;
  const Json& last = cell["rows"].back();
  json["at_n"] = last["n"];
  json["value"] = last["efficiency"];
  json["reason"] = "";
  if (!last["efficiency"].is_number())
    json["reason"] = last["below_reference"] == true ? "the last row is below the reference's error"
                     : last["rmse"].is_number()
                         ? "the RMSE of the last row is unresolved or 0, or its time is 0"
                         : "the last row has no RMSE";
}

}  // namespace

Json efficiency_json(const CellResult& result, const Json& cell, unsigned max_log2_n) {
  const std::optional<double> truth = truth_of(result);
  const CurveFacts curve = curve_of(result, max_log2_n);
  Json json;
  add_value(cell, json);
  json["relative_to"] = truth ? Json(*truth != 0 ? std::fabs(*truth) : 1) : Json(nullptr);
  json["tolerances"] = !truth ? Json(nullptr) : Json(*truth != 0 ? "relative" : "absolute");
  json["time_line"] = times_json(curve.times);
  json["time_to_tolerance"] = Json::array();
  for (int digits = 1; digits <= kTolerances; ++digits)
    json["time_to_tolerance"].push_back(tolerance_json(curve, digits, truth));
  json["speed_up_over"] = {{"cell", nullptr}, {"error_by", nullptr}, {"reason", kSeenLater}};
  for (const char* at : {"equal_n", "equal_time"})
    json["crossover"][at] = {{"n", nullptr}, {"reason", kSeenLater}};
  return json;
}

}  // namespace koksma
