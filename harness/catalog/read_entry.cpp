#include "catalog/read_entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "error/error.hpp"

namespace koksma {
namespace {

ExactSource read_exact(const Json& exact, const char* key, std::string_view where) {
  ExactSource result;
  const auto found = exact.find(key);
  if (found == exact.end()) return result;
  const std::string from = found->at("from");
  using Kind = ExactSource::Kind;
  result.kind = from == "formula"     ? Kind::formula
                : from == "mean"      ? Kind::mean
                : from == "constant"  ? Kind::constant
                : from == "table"     ? Kind::table
                : from == "undefined" ? Kind::undefined
                                      : Kind::none;
  result.source = found->value("source", "");
  result.infinite = found->value("infinite", false);
  result.tolerance = found->value("tolerance", result.tolerance);
  if (result.kind == Kind::constant) {
    if (!found->contains("value"))
      throw InputError(fmt::format("{}, at '/exact/{}'", where, key), "a constant without a value",
                       "give \"value\": \"1.25\"");
    result.value = std::stod(found->at("value").get<std::string>());
  }
  return result;
}

std::vector<ParameterValue> read_parameter_values(const Json& entry, const char* key,
                                                  const Integrand& f, std::string_view where) {
  std::vector<ParameterValue> result;
  const Json values = entry.value(key, Json::object());
  for (const auto& [name, value] : values.items()) {
    std::vector<std::string> known;
    for (const Parameter& p : f.parameters) known.push_back(p.name);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw unknown_name(fmt::format("{}, the rates of class '{}', {}", where, f.smoothness, key),
                         "parameter", name, known);
    result.push_back({static_cast<std::size_t>(found - known.begin()), value});
  }
  return result;
}

void read_rates(const Json& rates, Integrand& f, std::string_view where) {
  for (const auto& [sampler_class, entry] : rates.items()) {
    ExpectedRate rate;
    rate.constant = entry.at("constant");
    rate.per_dimension = entry.value("per_dimension", 0.0);
    rate.per_parameter = read_parameter_values(entry, "per_parameter", f, where);
    rate.per_parameter_over_dimension =
        read_parameter_values(entry, "per_parameter_over_dimension", f, where);
    if (entry.contains("at_least")) rate.at_least = entry.at("at_least").get<double>();
    rate.source = entry.at("source");
    if (const auto gate = entry.find("gate"); gate != entry.end()) {
      rate.gate_max_d = gate->at("max_d").get<std::uint32_t>();
      rate.gate_tolerance = gate->value("tolerance", 0.0);
      if (gate->contains("at_most")) rate.gate_at_most = gate->at("at_most").get<double>();
      rate.log_correction = gate->value("log_correction", false);
      rate.gate_parameters_at_most = read_parameter_values(*gate, "parameters_at_most", f, where);
    }
    f.expected[sampler_class] = rate;
  }
}

std::vector<Choice> read_choices(const Json& entry, std::string_view where) {
  std::vector<Choice> result;
  const Json list = entry.value("choices", Json::array());
  for (const Json& item : list) {
    Choice choice{item["name"], item["meaning"], item["allowed"].get<std::vector<std::string>>(),
                  item["default"], item.value("kind", "") == "solver"};
    if (std::find(choice.allowed.begin(), choice.allowed.end(), choice.default_value) ==
        choice.allowed.end())
      throw unknown_name(fmt::format("{}, at '/choices/{}/default'", where, result.size()), "value",
                         choice.default_value, choice.allowed);
    result.push_back(std::move(choice));
  }
  return result;
}

// What the schema cannot say: ranges hold their defaults, and parameters can be told apart.
void check_ranges(const Integrand& f, std::string_view where) {
  if (f.default_dim < f.min_dim || f.default_dim > f.max_dim)
    throw InputError(fmt::format("{}, at '/dimensions/default'", where),
                     fmt::format("d = {}", f.default_dim),
                     fmt::format("allowed: {} to {}", f.min_dim, f.max_dim));
  std::set<std::string> taken{"d"};
  for (std::size_t i = 0; i < f.choices.size(); ++i)
    if (!taken.insert(f.choices[i].name).second)
      throw InputError(fmt::format("{}, at '/choices/{}/name'", where, i),
                       fmt::format("the name '{}' is taken", f.choices[i].name),
                       "give every choice its own name");
  for (std::size_t i = 0; i < f.parameters.size(); ++i) {
    const Parameter& p = f.parameters[i];
    const std::string at = fmt::format("{}, at '/parameters/{}", where, i);
    if (!(p.default_value >= p.min && p.default_value <= p.max))
      throw InputError(at + "/default'", fmt::format("{} = {}", p.name, p.default_value),
                       fmt::format("allowed: {} to {}", p.min, p.max));
    if (!taken.insert(p.name).second)
      throw InputError(at + "/name'", fmt::format("the name '{}' is taken", p.name),
                       "d is the dimension; give every parameter its own name");
  }
}

// The values of checks and cases are of parameters and choices that there are: a name misspelt
// would stand for the default, without a word.
void check_values(const Json& entry, const Integrand& f, std::string_view where) {
  std::vector<std::string> known;
  for (const Parameter& p : f.parameters) known.push_back(p.name);
  for (const Choice& c : f.choices) known.push_back(c.name);
  for (const char* key : {"checks", "sample_checks", "stability"}) {
    const Json list = entry.value(key, Json::array());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string at = fmt::format("{}, at '/{}/{}/parameters'", where, key, i);
      const Json& values = list[i]["parameters"];
      for (const auto& item : values.items()) {
        const std::string& name = item.key();  // clang 14 captures no structured bindings
        const Json& value = item.value();
        if (std::find(known.begin(), known.end(), name) == known.end())
          throw unknown_name(at, "parameter", name, known);
        const auto choice = std::find_if(f.choices.begin(), f.choices.end(),
                                         [&](const Choice& c) { return c.name == name; });
        if (value.is_string() != (choice != f.choices.end()))
          throw InputError(at, fmt::format("{} = {}", name, value.dump()),
                           "a parameter is a number, a choice one of its values");
        if (choice != f.choices.end() && std::find(choice->allowed.begin(), choice->allowed.end(),
                                                   value) == choice->allowed.end())
          throw unknown_name(at, fmt::format("value of {}", name), value.get<std::string>(),
                             choice->allowed);
      }
    }
  }
}

}  // namespace

Sampler read_sampler(const Json& entry, const std::string& family) {
  Sampler s;
  s.name = entry["name"];
  s.title = entry["title"];
  s.citation = entry["citation"];
  s.family = family;
  s.centred = entry["centred"];
  s.replicable = entry["replicable"];
  s.validity = entry["validity"].get<std::vector<std::string>>();
  s.default_estimator = entry["default_estimator"];
  s.size_form = entry["n"]["form"];
  s.extensible = entry["n"]["extensible"];
  s.max_log2_n = entry["n"]["max_log2"];
  s.min_dim = entry["dimensions"].value("min", 1U);
  s.max_dim = entry["dimensions"]["max"];
  s.precisions = entry.value("precisions", std::vector<std::string>{"fp32", "fp64"});
  s.reads_directions = entry.value("reads_directions", false);
  s.rate_class = entry["rate_class"];
  s.rotated_rate_class = entry.value("rotated_rate_class", "");
  for (const Json& p : entry.value("parameters", Json::array()))
    s.parameters.push_back({p["name"], p["meaning"], p["required"],
                            p.value("allowed", std::vector<std::string>{}),
                            p.value("path", false)});
  s.speed = entry.value("speed", std::map<std::string, double>{});
  s.properties = entry["properties"].get<std::vector<std::string>>();
  s.options = entry["options"];
  s.defines = entry["defines"].get<std::map<std::string, int>>();
  s.known_answers = entry.value("known_answers", Json::array());
  return s;
}

namespace {

std::vector<RoundingTerm> read_rounding(const Json& terms) {
  std::vector<RoundingTerm> result;
  for (const Json& term : terms)
    result.push_back({term.at("factor"), term.value("n", 0.0), term.value("u", 0.0)});
  return result;
}

std::optional<DigitWeights> read_digits(const Json& entry, const char* precision) {
  const auto found = entry.find("digits");
  if (found == entry.end()) return std::nullopt;
  return DigitWeights{found->at(precision).at("first"), found->at(precision).at("step")};
}

}  // namespace

SumAlgorithm read_sum(const Json& entry, SourceFile code) {
  SumAlgorithm s;
  s.name = entry["name"];
  s.title = entry["title"];
  s.citation = entry["citation"];
  const Json& words = entry["words"];
  s.words_fp32 = words.is_object() ? words["fp32"] : words;
  s.words_fp64 = words.is_object() ? words["fp64"] : words;
  s.digits_fp32 = read_digits(entry, "fp32");
  s.digits_fp64 = read_digits(entry, "fp64");
  s.needs_fp64 = entry["word_type"] == "double";
  s.compensated = entry["compensated"];
  s.order_free = entry["order_free"];
  s.bound = read_rounding(entry["error"]["bound"]);
  s.estimate = read_rounding(entry["error"]["estimate"]);
  if (const auto found = entry["error"].find("quantum_log2"); found != entry["error"].end())
    s.quantum = std::ldexp(1.0, found->get<int>());
  for (const Json& answer : entry.value("self_test", Json::array()))
    s.self_test.push_back({answer["terms"].get<std::vector<double>>(), answer["sum"]});
  s.preference = entry["preference"];
  s.code = std::move(code);
  return s;
}

Solver read_solver(const Json& entry, SourceFile code) {
  Solver s;
  s.name = entry["name"];
  s.title = entry["title"];
  s.citation = entry["citation"];
  s.order = entry["order"];
  s.adaptive = entry["adaptive"];
  if (entry.contains("least_tolerance")) {
    s.least_tolerance_fp32 = entry["least_tolerance"]["fp32"];
    s.least_tolerance_fp64 = entry["least_tolerance"]["fp64"];
  }
  s.numerator = entry["stability"]["numerator"].get<std::vector<double>>();
  s.denominator = entry["stability"]["denominator"].get<std::vector<double>>();
  s.properties = entry["properties"].get<std::vector<std::string>>();
  s.code = std::move(code);
  return s;
}

Estimator read_estimator(const Json& entry) {
  Estimator e;
  e.name = entry["name"];
  e.title = entry["title"];
  e.citation = entry["citation"];
  e.fits = entry["fits"].get<std::vector<std::string>>();
  e.moments = entry["moments"];
  e.interval = entry["interval"];
  e.replicated = entry["replicated"];
  e.second_moment = entry.value("second_moment", "");
  e.replicates_per_estimate = entry.value("replicates_per_estimate", 1U);
  e.rate_suffix = entry.value("rate_suffix", "");
  e.note = entry.value("note", "");
  return e;
}

Integrand read_integrand(const Json& entry, const Json& classes, std::string_view where,
                         SourceFile code) {
  Integrand f;
  f.name = entry["name"];
  f.title = entry["title"];
  f.citation = entry["citation"];
  f.smoothness = entry["class"];
  f.periodic = entry["periodic"];
  f.exact_operations = entry["exact_operations"];
  f.nonnegative = entry["nonnegative"];
  for (const Json& p : entry["parameters"])
    f.parameters.push_back(
        {p["name"], p["meaning"], p["default"], p["min"], p["max"], p.value("integer", false)});
  f.choices = read_choices(entry, where);
  if (entry.contains("ode")) f.ode_size = entry["ode"]["size"];
  f.min_dim = entry["dimensions"]["min"];
  f.max_dim = entry["dimensions"]["max"];
  f.default_dim = entry["dimensions"]["default"];
  f.coefficients = entry["coefficients"].get<std::vector<std::string>>();
  f.transforms = entry["transforms"].get<std::vector<std::string>>();
  f.dimension_order = entry.value("dimension_order", false);
  f.all_coordinates = !entry.value("needs", Json::array()).empty();
  if (entry.contains("ulps")) {
    f.ulps_fp32 = entry["ulps"]["fp32"];
    f.ulps_fp64 = entry["ulps"]["fp64"];
  }
  f.mean = read_exact(entry["exact"], "mean", where);
  f.variance = read_exact(entry["exact"], "variance", where);
  f.mean_abs = read_exact(entry["exact"], "mean_abs", where);
  f.variation = read_exact(entry["exact"], "variation", where);
  f.discrete = read_exact(entry["exact"], "discrete", where);
  f.bound = read_exact(entry["exact"], "bound", where);
  f.stiffness = read_exact(entry["exact"], "stiffness", where);
  if (entry["exact"].contains("kurtosis"))
    f.fourth_moment = entry["exact"]["kurtosis"]["from"] == "indicator" ? FourthMoment::indicator
                                                                        : FourthMoment::unknown;
  f.checks = entry.value("checks", Json::array());
  f.sample_checks = entry.value("sample_checks", Json::array());
  f.stability = entry.value("stability", Json::array());
  f.code = std::move(code);

  check_ranges(f, where);
  check_values(entry, f, where);
  const bool solves = std::any_of(f.choices.begin(), f.choices.end(),
                                  [](const Choice& choice) { return choice.is_solver; });
  if (solves != (f.ode_size > 0))
    throw InputError(fmt::format("{}, at '/ode'", where),
                     solves ? "a solver and no equations" : "equations and no solver",
                     "give \"ode\" and a choice of kind \"solver\", or neither");
  if (!classes.contains(f.smoothness)) {
    std::vector<std::string> names;
    for (const auto& [name, rates] : classes.items()) names.push_back(name);
    throw unknown_name(fmt::format("{}, at '/class'", where), "class", f.smoothness, names);
  }
  read_rates(classes[f.smoothness]["rates"], f, where);
  if (entry.contains("expected")) read_rates(entry["expected"], f, where);
  return f;
}

}  // namespace koksma
