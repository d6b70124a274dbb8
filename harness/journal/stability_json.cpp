#include "journal/stability_json.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "journal/cell_json.hpp"

namespace koksma {
namespace {

Json plateau_json(const RateFit& rate) {
  const Plateau& plateau = rate.plateau;
  const bool found = plateau.kind != PlateauKind::none;
  Json json = {{"kind", plateau_name(plateau.kind)}, {"reason", plateau.reason}};
  json["from"] = found ? Json(plateau.from) : Json(nullptr);
  json["slope"] = found ? number_or_null(plateau.slope) : Json(nullptr);
  json["level"] = found ? number_or_null(plateau.level) : Json(nullptr);
  json["break"] = nullptr;
  if (rate.bend)
    json["break"] = {{"n", number_or_null(std::exp2(rate.bend->log2_samples))},
                     {"slope_before", number_or_null(rate.bend->slope_before)},
                     {"slope_after", number_or_null(rate.bend->slope_after)},
                     {"delta_aicc", number_or_null(rate.bend->delta_aicc)}};
  return json;
}

Json floor_json(const Floor& floor) {
  return {{"estimate", number_or_null(floor.estimate)},
          {"bound", number_or_null(floor.bound)},
          {"reason", floor.reason}};
}

Json floors_json(const Floors& floors) {
  Json json;
  json["integrator"] = floor_json(floors.integrator);
  json["coordinate"] = floor_json(floors.coordinate);
  json["integrand"] = floor_json(floors.integrand);
  json["summation"] = floor_json(floors.summation);
  json["reference"] = number_or_null(floors.reference);
  json["predicted_total"] = number_or_null(floors.predicted_total());
  json["dominant"] = floors.dominant().empty() ? Json(nullptr) : Json(floors.dominant());
  return json;
}

// Of single estimates at the largest N, as in its row.
Json error_json(const CellResult& result) {
  const ErrorStatistics none;
  const ErrorStatistics& e = result.rows.empty() ? none : result.rows.back().errors;
  Json json;
  json["rmse"] = number_or_null(e.rmse);
  json["rmse_ci"] = e.rmse_low && e.rmse_high ? interval_json(Interval{*e.rmse_low, *e.rmse_high})
                                              : Json(nullptr);
  json["median_abs"] = number_or_null(e.median_abs);
  json["rho"] = number_or_null(e.rho);
  json["bias"] = number_or_null(e.bias);
  json["z_bias"] = number_or_null(result.stability.z_bias);
  return json;
}

// Which points were excluded, and why, is under `convergence`.
Json rate_json(const CellResult& result, const std::string& source) {
  const RateFit& rate = result.rate;
  Json json;
  json["slope"] = number_or_null(rate.slope);
  json["ci"] = interval_json(rate.interval);
  json["theory"] = number_or_null(result.verdict.expected);
  json["source"] = source;
  json["points_used"] = rate.used.size();
  json["excluded"] = rate.excluded.size();
  json["reason"] = rate.reason;
  return json;
}

Json counters_json(const CellResult& result) {
  if (result.rows.empty() || !result.rows.back().counters) return nullptr;
  const Counters& k = *result.rows.back().counters;
  return {{"nan", k.nan},
          {"inf", k.plus_inf + k.minus_inf},
          {"denorm", k.denorm_out},
          {"denorm_in", k.denorm_in},
          {"coord_le0", k.coord_le0},
          {"coord_ge1", k.coord_ge1},
          {"hits", k.hits},
          {"blow_ups", k.blow_ups},
          {"max_abs", number_or_null(k.max_abs)}};
}

Json ode_json(const CellResult& result) {
  if (!result.ode) return nullptr;
  const OdeReport& ode = *result.ode;
  const auto word = [](std::string_view text) { return text.empty() ? Json(nullptr) : Json(text); };
  Json json;
  json["sampling_rmse"] = number_or_null(ode.sampling_rmse);
  json["sampling_against"] = word(ode.sampling_against);
  json["total_rmse"] = number_or_null(ode.total_rmse);
  json["integrator_bias"] = number_or_null(ode.integrator_bias);
  json["relative_bias"] = number_or_null(ode.relative_bias(result.exact.mean));
  json["bias_standard_error"] = number_or_null(ode.bias_error);
  json["bias_from"] = word(ode.bias_from);
  json["stiffness"] = number_or_null(ode.stiffness);
  json["max_abs_r"] = number_or_null(ode.max_abs_r);
  json["blow_ups"] = ode.blow_ups ? Json(*ode.blow_ups) : Json(nullptr);
  return json;
}

// E|f|/|I|; null also where it is infinite.
Json kappa_json(const CellResult& result) {
  const ExactValues& exact = result.exact;
  if (!exact.mean || !exact.mean_abs || *exact.mean == 0) return nullptr;
  return number_or_null(*exact.mean_abs / std::fabs(*exact.mean));
}

Json mc_chi2_p_json(const CellResult& result) {
  if (result.rows.empty() || !result.rows.back().mc_test.applicable) return nullptr;
  return number_or_null(result.rows.back().mc_test.p_value);
}

// What `koksma stability` alone measures, and how the program was built.
void add_environment(const CellResult& result, const Plan* plan, Json& json) {
  const StabilityDetail& detail = result.detail;
  json["index"] = nullptr;
  if (detail.index)
    json["index"] = {{"sum_i_ok", detail.index->sum_ok},
                     {"sum_i2_ok", detail.index->sum_of_squares_ok},
                     {"xor_ok", detail.index->xor_of_hashes_ok}};
  json["repro"] = nullptr;
  if (detail.reproducibility)
    json["repro"] = {{"launch_shapes", detail.reproducibility->launch_shapes},
                     {"distinct_sums", detail.reproducibility->distinct_sums},
                     {"ulp_spread", number_or_null(detail.reproducibility->ulp_spread)}};
  json["eft_selftest"] = detail.eft_selftest ? Json(*detail.eft_selftest) : Json(nullptr);
  json["precision_gap"] = nullptr;
  if (detail.precision_gap)
    json["precision_gap"] = {{"q32_minus_q64", number_or_null(detail.precision_gap->difference)},
                             {"in_rmse64", number_or_null(detail.precision_gap->in_rmse64)}};
  json["build_options"] = plan != nullptr ? Json(plan->program.options) : Json(nullptr);
  json["fp_contract"] = nullptr;
  if (plan != nullptr) {
    const bool off = plan->program.text.find("FP_CONTRACT OFF") != std::string::npos;
    json["fp_contract"] = off ? "off in parts" : "default";
  }
  json["cl_fp_config32"] = plan != nullptr ? Json(plan->fp_config32) : Json(nullptr);
  json["cl_fp_config64"] = plan != nullptr ? Json(plan->fp_config64) : Json(nullptr);
}

// Seconds, and those to two of the tolerances of `efficiency`.
void add_work(const CellResult& result, const Json& cell, Json& json) {
  json["t_build"] = result.build_s;
  json["t_kernel"] = json["t_transfer"] = json["efficiency"] = nullptr;
  json["time_to_tol"] = {{"1e-3", nullptr}, {"1e-6", nullptr}};
  if (result.rows.empty()) return;
  const Row& last = result.rows.back();
  json["t_kernel"] = last.kernel.median;
  json["t_transfer"] = std::max(0.0, last.wall.median - last.merged_kernel_s);
  json["efficiency"] = cell["rows"].back()["efficiency"];
  for (const Json& t : cell["efficiency"]["time_to_tolerance"])
    for (const char* tolerance : {"1e-3", "1e-6"})
      if (t["tolerance"] == std::stod(tolerance)) json["time_to_tol"][tolerance] = t["seconds"];
}

// Null members and why they are.
Json not_measured(const Json& json) {
  constexpr const char* kOnlyThere = "measured by `koksma stability`";
  // Of a cell of the suite, whose indices were checked.
  constexpr const char* kNotHere = "the error is not near a floor, or a sum is not finite";
  const bool there = !json["index"].is_null();
  Json reasons = Json::object();
  for (const char* key : {"index", "repro", "eft_selftest", "precision_gap"})
    if (json[key].is_null()) reasons[key] = there ? kNotHere : kOnlyThere;
  if (json["counters"].is_null())
    reasons["counters"] = "counted by `koksma stability`, and where a sum is not finite";
  return reasons;
}

}  // namespace

Json stability_json(const CellResult& result, const Plan* plan, const Json& cell) {
  const CellVerdict& stability = result.stability;
  Json json;
  json["verdict"] = stability.verdict.empty() ? Json(nullptr) : Json(stability.verdict);
  json["reason"] = stability.reason;
  json["marks"] = Json::array();
  for (const std::string_view mark : stability.marks) json["marks"].push_back(mark);
  json["error"] = error_json(result);
  json["rate"] = rate_json(result, cell["convergence"]["source"]);
  json["floors"] = floors_json(result.floors);
  json["kappa"] = kappa_json(result);
  json["kappa_seen"] =
      result.rows.empty() ? Json(nullptr) : number_or_null(result.rows.back().kappa);
  json["n_eff"] = number_or_null(stability.n_eff);
  json["n_eff_seen"] = number_or_null(stability.empirical_n_eff);
  json["mc_chi2_p"] = mc_chi2_p_json(result);
  json["infinite_variance"] = result.exact.infinite_variance;
  json["plateau"] = plateau_json(result.rate);
  json["counters"] = counters_json(result);
  json["ode"] = ode_json(result);
  add_environment(result, plan, json);
  add_work(result, cell, json);
  json["not_measured"] = not_measured(json);
  return json;
}

}  // namespace koksma
