#include "journal/cell_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimate/efficiency.hpp"

namespace koksma {
namespace {

Json interval_json(const std::optional<Interval>& interval) {
  if (!interval) return nullptr;
  return Json::array({number_or_null(interval->low), number_or_null(interval->high)});
}

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

Json mc_test_json(const McTest& test) {
  if (!test.applicable) return {{"applicable", false}, {"reason", test.reason}};
  return {{"applicable", true},
          {"statistic", number_or_null(test.statistic)},
          {"degrees_of_freedom", test.replicates},
          {"p_value", number_or_null(test.p_value)}};
}

// A launch costs about 60 us (measured on PoCL): below a millisecond it shows in the time of the
// kernel.
bool launch_bound(const Row& row) { return row.kernel.median < 1e-3; }

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
  const std::optional<double> mean = result.exact.mean;
  Json json;
  json["sampling_rmse"] = number_or_null(ode.sampling_rmse);
  json["sampling_against"] = word(ode.sampling_against);
  json["total_rmse"] = number_or_null(ode.total_rmse);
  json["integrator_bias"] = number_or_null(ode.integrator_bias);
  json["relative_bias"] = ode.integrator_bias && mean && *mean != 0
                              ? number_or_null(*ode.integrator_bias / *mean)
                              : Json(nullptr);
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
  json["t_transfer"] = std::max(0.0, last.wall.median - last.kernel.median);
  json["efficiency"] = cell["rows"].back()["efficiency"];
  for (const Json& t : cell["efficiency"]["time_to_tolerance"])
    for (const char* tolerance : {"1e-3", "1e-6"})
      if (t["tolerance"] == std::stod(tolerance)) json["time_to_tol"][tolerance] = t["seconds"];
}

// Null members and why they are.
Json not_measured(const Json& json) {
  constexpr const char* kOnlyThere = "measured by `koksma stability`";
  Json reasons = Json::object();
  for (const char* key : {"index", "repro", "eft_selftest", "precision_gap"})
    if (json[key].is_null()) reasons[key] = kOnlyThere;
  if (json["counters"].is_null())
    reasons["counters"] = "counted by `koksma stability`, and where a sum is not finite";
  return reasons;
}

// `cell`: the JSON of the cell so far.
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

// Kernel time of one replicate to each relative tolerance (of |I|, or absolute where I = 0), from
// the resolved rows that measure the kernel and not its launch, and errors and not the reference's.
Json efficiency_json(const CellResult& result) {
  Json json = {{"relative_to", nullptr}, {"time_to_tolerance", Json::array()}};
  if (!result.exact.mean && !result.reference) return json;
  const double truth = result.exact.mean ? *result.exact.mean : result.reference->value;
  const double scale = truth != 0 ? std::fabs(truth) : 1;
  json["relative_to"] = scale;
  std::vector<TimePoint> points;
  double largest = 0;
  for (const Row& row : result.rows) {
    if (!row.errors.rmse || !row.unresolved.empty() || row.below_reference || launch_bound(row)) continue;
    points.push_back({row.kernel.median / result.cell.replicates, *row.errors.rmse});
    largest = std::max(largest, *row.errors.rmse);
  }
  for (int digits = 1; digits <= 12; ++digits) {
    const double tolerance = std::pow(10.0, -digits);
    TimeToTolerance t = time_to_tolerance(points, tolerance * scale);
    if (!points.empty() && tolerance * scale > largest)
      t = {std::nullopt, false, "met by the first row that is not launch-bound"};
    json["time_to_tolerance"].push_back({{"tolerance", tolerance},
                                         {"seconds", number_or_null(t.seconds)},
                                         {"extrapolated", t.extrapolated},
                                         {"reason", t.reason}});
  }
  return json;
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
  json["efficiency"] = efficiency_json(result);
  json["stability"] = stability_json(result, plan, json);
  return json;
}

}  // namespace koksma
