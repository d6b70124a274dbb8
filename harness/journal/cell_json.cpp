#include "journal/cell_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "estimate/efficiency.hpp"
#include "journal/efficiency_json.hpp"
#include "journal/stability_json.hpp"

namespace koksma {
namespace {

// `digits`: the verified digits where the entry's checks have this scene, else those of the double.
Json exact_json(const std::optional<double>& value, const ExactSource& source, const Json* check,
                const char* key) {
  Json result;
  result["value"] = number_or_null(value);
  const bool verified = check != nullptr && check->contains(key) && (*check)[key].is_string();
  result["digits"] = verified ? (*check)[key]
                     : value  ? Json(fmt::format("{:.17g}", *value))
                              : Json(nullptr);
  result["source"] = source.source;
  return result;
}

Json scene_json(const Catalog& catalog, const CellResult& result) {
  const Integrand& f = catalog.integrand(result.cell.scene.integrand, "scene");
  Json scene;
  scene["text"] = result.cell.scene.text;
  scene["integrand"] = f.name;
  scene["d"] = result.cell.scene.dim;
  scene["parameters"] = Json::object();
  for (std::size_t i = 0; i < f.parameters.size(); ++i)
    scene["parameters"][f.parameters[i].name] = result.cell.scene.parameters[i];
  scene["choices"] = Json::object();
  for (std::size_t i = 0; i < f.choices.size(); ++i)
    scene["choices"][f.choices[i].name] = result.cell.scene.choices[i];
  scene["class"] = f.smoothness;
  const Json* check = matching_check(f, result.cell.scene);
  scene["exact"]["mean"] = exact_json(result.exact.mean, f.mean, check, "mean");
  scene["exact"]["variance"] = exact_json(result.exact.variance, f.variance, check, "variance");
  scene["exact"]["mean_abs"] = exact_json(result.exact.mean_abs, f.mean_abs, check, "mean_abs");
  return scene;
}

Json time_json(const TimeStatistics& t) {
  return {{"median", t.median}, {"min", t.min}, {"spread", t.spread}, {"count", t.count}};
}

// Of five digits: more than a clock is good for.
Json times_json(const std::vector<double>& times) {
  Json json = Json::array();
  for (const double t : times) json.push_back(std::stod(fmt::format("{:.4e}", t)));
  return json;
}

Json mc_test_json(const McTest& test) {
  if (!test.applicable) return {{"applicable", false}, {"reason", test.reason}};
  return {{"applicable", true},
          {"statistic", number_or_null(test.statistic)},
          {"degrees_of_freedom", test.replicates},
          {"p_value", number_or_null(test.p_value)}};
}

// About 8 us go into a launch's start (PoCL): in shorter launches a tenth of the kernel's time.
bool launch_bound(const Row& row) {
  return row.kernel.median * row.runs_per_launch < kSecondsOfRuns / 2;
}

Json row_json(const Row& row, const CellResult& result, const Estimator& estimator) {
  const double samples =
      static_cast<double>(row.n) * result.cell.replicates * estimator.replicates_per_estimate;
  const double seconds = row.kernel.median / result.cell.replicates;  // of one replicate
  const ErrorStatistics& e = row.errors;
  // What rests on an RMSE that f has been missed by means nothing.
  const bool resolved = e.rmse && row.unresolved.empty();
  Json json;
  json["n"] = row.n;
  json["log2_block"] = row.log2_block;
  json["estimate"] = number_or_null(row.estimate.value);
  json["standard_error"] = number_or_null(row.estimate.standard_error);
  json["interval"] = interval_json(row.estimate.interval);
  json["interval_level"] = row.estimate.interval ? Json(row.estimate.level) : Json(nullptr);
  json["interval_reason"] = row.estimate.reason;
  json["error_against"] = result.exact.mean  ? Json("exact value")
                          : result.reference ? Json("own best estimate")
                                             : Json(nullptr);
  json["error_reason"] = row.error_reason;
  json["below_reference"] = row.below_reference;
  json["rmse"] = number_or_null(e.rmse);
  json["rmse_interval"] = resolved && e.rmse_low && e.rmse_high
                              ? interval_json(Interval{*e.rmse_low, *e.rmse_high})
                              : Json(nullptr);
  json["rmse_interval_method"] = e.rmse_interval_method;
  json["median_abs_error"] = number_or_null(e.median_abs);
  json["bias"] = number_or_null(e.bias);
  json["sd"] = number_or_null(e.sd);
  json["rho"] = number_or_null(e.rho);
  json["heavy_tailed"] = e.heavy_tailed;
  json["mc_chi2"] = mc_test_json(row.mc_test);
  json["nonfinite"] = row.nonfinite;
  json["grid_limited"] = row.grid_limited;
  json["kernel_s"] = time_json(row.kernel);
  json["wall_s"] = time_json(row.wall);
  json["runs_per_launch"] = row.runs_per_launch;
  if (!row.kernel_times.empty()) json["kernel_times_s"] = times_json(row.kernel_times);
  if (!row.calibration.empty()) json["calibration_s"] = times_json(row.calibration);
  json["launch_bound"] = launch_bound(row);
  json["seconds_per_replicate"] = seconds;
  json["samples_per_s"] = row.kernel.median > 0 ? Json(samples / row.kernel.median) : Json(nullptr);
  json["coordinates_per_s"] = row.kernel.median > 0
                                  ? Json(samples * result.cell.scene.dim / row.kernel.median)
                                  : Json(nullptr);
  const bool believed = resolved && !row.below_reference;
  json["efficiency"] = believed ? number_or_null(efficiency(*e.rmse, seconds)) : Json(nullptr);
  json["variance_reduction"] =
      believed && result.exact.variance
          ? number_or_null(variance_reduction(*result.exact.variance,
                                              row.n * estimator.replicates_per_estimate, *e.rmse))
          : Json(nullptr);
  json["speed_up"] = nullptr;  // set by the report, which sees the other cells
  return json;
}

Json convergence_json(const CellResult& result, const ExpectedRate* expected) {
  const RateFit& rate = result.rate;
  Json json;
  json["rate"] = number_or_null(rate.slope);
  json["intercept"] = number_or_null(rate.intercept);
  json["interval"] = interval_json(rate.interval);
  json["reason"] = rate.reason;
  json["median_rate"] = number_or_null(rate.median_slope);
  json["median_interval"] = interval_json(rate.median_interval);
  json["heavy_tailed"] = rate.heavy_tailed;
  json["deterministic"] = rate.deterministic;
  json["rows_used"] = rate.used;
  json["rows_excluded"] = Json::array();
  for (const ExcludedRow& row : rate.excluded)
    json["rows_excluded"].push_back({{"n", row.samples}, {"reason", row.reason}});
  json["local_slopes"] = Json::array();
  for (const LocalSlope& s : rate.local_slopes)
    json["local_slopes"].push_back(
        {{"from", s.from}, {"to", s.to}, {"slope", number_or_null(s.slope)}});
  json["expected"] = number_or_null(result.verdict.expected);
  json["target"] = number_or_null(result.verdict.target);
  json["source"] = expected == nullptr ? "" : expected->source;
  json["verdict"] = result.verdict.verdict;
  json["verdict_reason"] = result.verdict.reason;
  return json;
}

Json stopped_json(const CellResult& result) {
  const Stopped& s = result.stopped;
  if (result.rows.empty()) return nullptr;
  return {{"by", s.by},
          {"reason", s.reason},
          {"at_n", s.at_n},
          {"next_n", s.next_n ? Json(*s.next_n) : Json(nullptr)},
          {"spent_s", s.spent_s},
          {"predicted_s", number_or_null(s.predicted_s)},
          {"reached", number_or_null(s.reached)}};
}

Json stop_rule_json(const StopRule& rule) {
  return {{"time_budget", number_or_null(rule.time_budget)},
          {"until", number_or_null(rule.until)},
          {"beyond_n", rule.beyond_n ? Json(*rule.beyond_n) : Json(nullptr)}};
}

Json plan_json(const CellResult& result, const Plan& plan) {
  Json json;
  json["dimensions_drawn"] = plan.request.dim;
  json["coordinate_bits"] = plan.coordinate_bits;
  json["table_bytes"] = result.table_bytes;
  json["coefficient_bytes"] = result.coefficient_bytes;
  json["lanes_per_item"] = plan.shape.lanes_per_item;
  json["local_size"] = plan.shape.local_size;
  json["moments"] = plan.estimator->moments;
  json["replicates_per_estimate"] = plan.estimator->replicates_per_estimate;
  json["build_options"] = plan.program.options;
  json["left_out"] = Json::array();
  for (const LeftOut& item : plan.left_out)
    json["left_out"].push_back({{"what", item.what}, {"why", item.why}});
  return json;
}

}  // namespace

Json number_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json interval_json(const std::optional<Interval>& interval) {
  if (!interval) return nullptr;
  return Json::array({number_or_null(interval->low), number_or_null(interval->high)});
}

Json cell_identity(const Cell& cell) {
  Json json;
  json["scene"] = cell.scene.text;
  json["sampler"] = cell.sampler;
  json["estimator"] = cell.estimator;
  json["precision"] = cell.precision ? Json(precision_name(*cell.precision)) : Json(nullptr);
  json["sum"] = cell.sum;
  json["n"] = cell.n;
  json["replicates"] = cell.replicates;
  json["seed"] = cell.seed;
  json["stop"] = stop_rule_json(cell.stop);
  json["launches"] = cell.launches ? Json(*cell.launches) : Json(nullptr);
  return json;
}

Json cell_to_json(const Catalog& catalog, const CellResult& result, const Plan* plan) {
  Json json;
  json["scene"] = scene_json(catalog, result);
  json["sampler"] = result.cell.sampler;
  json["estimator"] = result.cell.estimator;
  const auto precision = plan != nullptr ? std::optional(plan->precision) : result.cell.precision;
  json["precision"] = precision ? Json(precision_name(*precision)) : Json(nullptr);
  json["sum"] = plan != nullptr ? plan->sum->name : result.cell.sum;
  json["replicates"] = result.cell.replicates;
  json["launches"] = result.cell.launches ? Json(*result.cell.launches) : Json(nullptr);
  json["seed"] = result.cell.seed;
  json["status"] = status_name(result.status);
  json["reason"] = result.reason;
  json["plan"] = plan != nullptr ? plan_json(result, *plan) : Json(nullptr);
  json["build_s"] = result.build_s;
  json["setup_s"] = result.setup_s;
  json["reference"] = nullptr;
  if (result.reference)
    json["reference"] = {{"value", number_or_null(result.reference->value)},
                         {"standard_error", number_or_null(result.reference->error)},
                         {"from", result.reference->from}};
  json["rounding_floor"] = number_or_null(result.floor);
  json["rows"] = Json::array();
  const Estimator& estimator = catalog.estimator(result.cell.estimator, "estimator");
  for (const Row& row : result.rows) json["rows"].push_back(row_json(row, result, estimator));
  const Integrand& f = catalog.integrand(result.cell.scene.integrand, "scene");
  const auto expected =
      f.expected.find(rate_class(catalog.sampler(result.cell.sampler, "sampler"),
                                 catalog.estimator(result.cell.estimator, "estimator")));
  json["convergence"] =
      convergence_json(result, expected == f.expected.end() ? nullptr : &expected->second);
  json["stopped"] = stopped_json(result);
  json["efficiency"] =
      efficiency_json(result, json, catalog.sampler(result.cell.sampler, "sampler").max_log2_n);
  json["stability"] = stability_json(result, plan, json);
  return json;
}

}  // namespace koksma
