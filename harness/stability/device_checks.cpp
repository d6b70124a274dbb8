#include "stability/device_checks.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "stability/specimens.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<Precision> precisions_of(const DeviceFacts& device) {
  if (device.fp64) return {Precision::fp32, Precision::fp64};
  return {Precision::fp32};
}

// Strict options are what every result rests on; of the others it is only told what they break.
void run_eft(const Catalog& catalog, Device& device, DeviceChecks& checks) {
  const auto start = Clock::now();
  for (const std::string& options : eft_option_sets())
    for (const Precision precision : precisions_of(device.facts()))
      checks.eft.push_back(test_error_free_transformations(catalog, device, precision, options));
  for (const EftResult& result : checks.eft)
    if (result.options.empty() && checks.eft_why.empty()) checks.eft_why = result.why_broken();
  checks.eft_ok = checks.eft_why.empty();
  checks.eft_seconds = seconds_since(start);
}

const EftResult& relaxed_fp32(const DeviceChecks& checks) {
  for (const EftResult& result : checks.eft)
    if (result.options == kRelaxedMathOption && result.precision == Precision::fp32) return result;
  return checks.eft.back();
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json outcome(bool ok, const std::string& why, double seconds) {
  return {{"ok", ok}, {"why", why.empty() ? Json(nullptr) : Json(why)}, {"seconds", seconds}};
}

Json eft_json(const DeviceChecks& checks) {
  Json json = outcome(checks.eft_ok, checks.eft_why, checks.eft_seconds);
  json["option_sets"] = Json::array();
  for (const EftResult& result : checks.eft) {
    Json failed = Json::array();
    for (const EftTest& test : result.tests)
      if (!test.passed)
        failed.push_back(
            {{"what", test.what}, {"expected", number(test.expected)}, {"got", number(test.got)}});
    json["option_sets"].push_back({{"options", result.options},
                                   {"precision", precision_name(result.precision)},
                                   {"selftest", result.intact() ? "intact" : "EFT_BROKEN"},
                                   {"tests", result.tests.size()},
                                   {"failed", failed}});
  }
  return json;
}

Json summation_json(const SummationTable& table) {
  Json json = outcome(table.ok, table.why, table.seconds);
  json["precision"] = precision_name(table.precision);
  json["host_agrees"] = table.host_agrees;
  json["rows"] = Json::array();
  for (const SummationRow& row : table.rows) {
    Json sums = Json::object();
    for (const SummationEntry& entry : row.entries)
      sums[entry.sum] = {{"error", number(entry.error)},
                         {"bound", number(entry.bound)},
                         {"seconds", entry.seconds}};
    json["rows"].push_back({{"terms", row.terms},
                            {"n_per_lane", row.n_per_lane},
                            {"kappa", number(row.kappa)},
                            {"sums", sums}});
  }
  json["relaxed_math"] = Json::object();
  for (const RelaxedSum& sum : table.relaxed)
    json["relaxed_math"][sum.sum] = {{"changed", sum.changed},
                                     {"strict_error", number(sum.strict_error)},
                                     {"relaxed_error", number(sum.relaxed_error)}};
  return json;
}

Json invariance_json(const Invariance& invariance) {
  Json json = outcome(invariance.ok, invariance.why, invariance.seconds);
  json["precision"] = precision_name(invariance.precision);
  json["n"] = invariance.n;
  json["launch_shapes"] = invariance.shapes;
  json["sums"] = Json::object();
  for (const InvarianceRow& row : invariance.rows)
    json["sums"][row.sum] = {{"order_free", row.order_free},
                             {"distinct_sums", row.distinct},
                             {"distinct_sums_of_one_block_length", row.most_of_one_block},
                             {"spread", number(row.spread)}};
  return json;
}

Json indices_json(const IndexChecks& indices) {
  Json json = outcome(indices.ok, indices.why, indices.seconds);
  json["checks"] = indices.checks.size();
  json["sum_i_ok"] = indices.sums_ok();
  json["sum_i2_ok"] = indices.squares_ok();
  json["xor_ok"] = indices.xors_ok();
  return json;
}

Json denormals_json(const DenormalChecks& denormals) {
  Json json = outcome(denormals.ok, denormals.why, denormals.seconds);
  json["cl_fp_config32"] = denormals.fp_config_fp32;
  json["cl_fp_config64"] = denormals.fp_config_fp64;
  json["results"] = Json::array();
  for (const DenormalResult& result : denormals.results)
    json["results"].push_back({{"options", result.options},
                               {"precision", precision_name(result.precision)},
                               {"product_flushed", result.product_flushed},
                               {"operand_flushed", result.operand_flushed},
                               {"compared_as_zero", result.compared_as_zero}});
  return json;
}

}  // namespace

DeviceChecks run_device_checks(const Catalog& catalog, Device& device) {
  const auto start = Clock::now();
  DeviceChecks checks;
  run_eft(catalog, device, checks);
  const Catalog terms = with_terms(catalog);
  checks.summation = measure_summation(terms, device, relaxed_fp32(checks));
  checks.invariance = measure_invariance(terms, device);
  checks.indices = check_indices(with_indices(catalog), device);
  checks.denormals = check_denormals(device);
  checks.seconds = seconds_since(start);
  return checks;
}

Json to_json(const DeviceChecks& checks) {
  return {{"ok", checks.ok()},
          {"seconds", checks.seconds},
          {"eft", eft_json(checks)},
          {"summation", summation_json(checks.summation)},
          {"invariance", invariance_json(checks.invariance)},
          {"indices", indices_json(checks.indices)},
          {"denormals", denormals_json(checks.denormals)}};
}

}  // namespace koksma
