#include "report/quality_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "report/results.hpp"
#include "report/text_table.hpp"

namespace koksma {
namespace {

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json measure_json(const Measure& m) {
  Json json;
  json["title"] = m.title;
  json["value"] = number_or_null(m.value);
  json["how"] = m.how;
  json["squared"] = m.squared ? Json(*m.squared) : Json(nullptr);
  json["method"] = m.method;
  json["reason"] = text_or_null(m.reason);
  return json;
}

Json pair_correlation_json(const Quality& q) {
  Json json;
  json["value"] = nullptr;
  json["method"] =
      "pairs at toroidal distances within a ring over N (N - 1) / 2 times its area; white noise is "
      "1";
  json["reason"] = text_or_null(q.pair_correlation_reason);
  if (!q.pair_correlation) return json;
  const PairCorrelation& g = *q.pair_correlation;
  json["value"] = {{"bin_width", g.bin_width}, {"radius", g.radius}, {"g", g.value}};
  return json;
}

Json power_spectrum_json(const Quality& q) {
  Json json;
  json["value"] = nullptr;
  json["method"] =
      "|sum exp(-2 pi i k.x)|^2 / N at integer frequencies, in rings of width 1 about 1, 2, ...; "
      "white noise is 1; anisotropy: variance within the ring over the squared mean, dB, -10 "
      "log10(distinct_sets) for white noise (Ulichney 1987; Lagae and Dutre, Comput. Graph. Forum "
      "27, 2008)";
  json["reason"] = text_or_null(q.power_spectrum_reason);
  if (!q.power_spectrum) return json;
  const PowerSpectrum& s = *q.power_spectrum;
  Json anisotropy = Json::array();
  for (const auto& db : s.anisotropy_db) anisotropy.push_back(number_or_null(db));
  json["value"] = {{"reach", s.reach},
                   {"distinct_sets", s.distinct_sets},
                   {"radial_mean", s.radial_mean},
                   {"anisotropy_db", anisotropy},
                   {"peak_frequency", s.peak_frequency},
                   {"low_frequency_power", number_or_null(s.low_frequency_power)},
                   {"null_reason",
                    "anisotropy: the ring has no power above rounding; low_frequency_power: no "
                    "integer frequency lies below a quarter of the peak"}};
  return json;
}

Json inequality_json(const KoksmaHlawka& k, const Quality& quality) {
  Json json;
  json["scene"] = k.scene.text;
  json["variation"] = number_or_null(k.variation);
  json["anchor"] = 1;
  json["variation_source"] = k.variation_source;
  json["star_how"] = quality.measure("star_upper").how;
  json["bound"] = number_or_null(k.bound);
  json["bound_reason"] = text_or_null(k.bound_reason);
  json["error"] = number_or_null(k.error);
  json["error_reason"] = text_or_null(k.error_reason);
  return json;
}

Json request_json(const QualityRequest& r) {
  return {{"sampler", r.sampler},       {"dim", r.dim},      {"n", r.n},
          {"replicates", r.replicates}, {"seed", r.seed},    {"precision", r.precision},
          {"directions", r.directions}, {"scenes", r.scenes}};
}

std::string measure_line(const Json& m) {
  const std::string title = m["title"];
  if (m["value"].is_null())
    return fmt::format("{:<50}  -           {}\n", title, m["reason"].get<std::string>());
  return fmt::format("{:<50}  {:<10.4g}  {}\n", title, m["value"].get<double>(),
                     m["how"].get<std::string>());
}

// Bounds are lines of their own only where they say more than the exact value.
bool repeats_exact(const std::string& name, const Json& measure) {
  return name.starts_with("star_") && measure["how"] == "exact";
}

std::string averages_text(const Json& averages) {
  std::string text;
  if (const Json& s = averages["power_spectrum"]["value"]; s.is_object()) {
    const Json& low = s["low_frequency_power"];
    const auto distinct = s["distinct_sets"].get<std::uint32_t>();
    if (distinct < averages["sets"].get<std::uint32_t>())
      text += fmt::format("power spectrum: {} distinct, the other sets are shifts of these\n",
                          distinct);
    text += fmt::format(
        "power spectrum: greatest in the ring |k| = {}, {} below a quarter of it\n",
        s["peak_frequency"].get<double>(),
        low.is_number() ? fmt::format("{:.3g} of white noise", low.get<double>()) : "no frequency");
  } else {
    text += fmt::format("power spectrum: {}\n",
                        averages["power_spectrum"]["reason"].get<std::string>());
  }
  if (const Json& g = averages["pair_correlation"]["value"]; g.is_object()) {
    const auto values = g["g"].get<std::vector<double>>();
    const auto most = std::max_element(values.begin(), values.end());
    text += fmt::format("pair correlation: at most {:.3g}, at r = {:.4g}\n", *most,
                        g["radius"][static_cast<std::size_t>(most - values.begin())].get<double>());
  } else {
    text += fmt::format("pair correlation: {}\n",
                        averages["pair_correlation"]["reason"].get<std::string>());
  }
  return text;
}

std::string inequality_line(const Json& k) {
  const auto number = [](const Json& value) { return number_text(value, "{:.4g}"); };
  std::string line =
      fmt::format("{}: |Q - I| = {}", k["scene"].get<std::string>(), number(k["error"]));
  if (k["bound"].is_number())
    line += fmt::format(" <= V D* = {} (V = {}, anchored at 1; D*: {})", number(k["bound"]),
                        number(k["variation"]), k["star_how"].get<std::string>());
  for (const char* key : {"bound_reason", "error_reason"})
    if (k[key].is_string()) line += "; " + k[key].get<std::string>();
  return line + "\n";
}

}  // namespace

Json quality_json(const QualityRequest& request, const Plan& plan, const DeviceFacts& device,
                  bool fp64_arithmetic, const Quality& quality,
                  const std::vector<KoksmaHlawka>& inequalities) {
  Study study;
  study.seed = request.seed;
  Json json;
  json["schema_version"] = kQualitySchemaVersion;
  json["context"] = make_context(device, study, request.command);
  json["context"].erase("study");
  json["context"]["request"] = request_json(request);
  json["points"] = {{"sampler", plan.sampler->name},
                    {"title", plan.sampler->title},
                    {"dim", request.dim},
                    {"n", request.n},
                    {"precision", precision_name(plan.precision)},
                    {"coordinate_bits", plan.coordinate_bits},
                    {"arithmetic", fp64_arithmetic ? "fp64" : "fp32"},
                    {"randomized", plan.sampler->replicable}};
  json["measures"] = Json::object();
  for (const Measure& m : quality.measures) json["measures"][m.name] = measure_json(m);
  json["averages"] = {{"sets", quality.sets},
                      {"pair_correlation", pair_correlation_json(quality)},
                      {"power_spectrum", power_spectrum_json(quality)}};
  json["koksma_hlawka"] = Json::array();
  for (const KoksmaHlawka& k : inequalities)
    json["koksma_hlawka"].push_back(inequality_json(k, quality));
  check_schema(json, "results/quality.schema.json", "quality");
  return json;
}

std::string quality_table(const Json& json) {
  const Json& points = json["points"];
  std::string text =
      fmt::format("{}, d = {}, N = {}, {} bits; {}; measures of {}\n\n",
                  points["sampler"].get<std::string>(), points["dim"].get<std::uint32_t>(),
                  points["n"].get<std::uint64_t>(), points["coordinate_bits"].get<std::uint32_t>(),
                  json["context"]["device"]["name"].get<std::string>(),
                  points["randomized"] == true ? "replicate 0" : "the one set there is");
  for (const auto& [name, measure] : json["measures"].items())
    if (!repeats_exact(name, measure)) text += measure_line(measure);
  const auto sets = json["averages"]["sets"].get<std::uint32_t>();
  text += fmt::format("\nover {} set{}\n", sets, sets == 1 ? "" : "s") +
          averages_text(json["averages"]);
  if (!json["koksma_hlawka"].empty()) text += "\nKoksma-Hlawka\n";
  for (const Json& k : json["koksma_hlawka"]) text += inequality_line(k);
  return text;
}

}  // namespace koksma
