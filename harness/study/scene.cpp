#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "error/error.hpp"
#include "study/study.hpp"

namespace koksma {
namespace {

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

// A decimal number or a fraction a/b, so that non-dyadic parameters are given exactly.
std::optional<double> parse_value(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_number(text);
  const auto above = parse_number(text.substr(0, slash));
  const auto below = parse_number(text.substr(slash + 1));
  if (!above || !below || *below == 0) return std::nullopt;
  return *above / *below;
}

void set_dimension(Scene& scene, const Integrand& f, double value, std::string_view where) {
  if (!(value >= f.min_dim && value <= f.max_dim) || value != std::floor(value))
    throw InputError(where, fmt::format("d = {} is out of range for '{}'", value, f.name),
                     fmt::format("allowed: whole numbers from {} to {}", f.min_dim, f.max_dim));
  scene.dim = static_cast<std::uint32_t>(value);
}

void set_parameter(Scene& scene, const Integrand& f, std::string_view key, double value,
                   std::string_view where) {
  for (std::size_t i = 0; i < f.parameters.size(); ++i) {
    const Parameter& p = f.parameters[i];
    if (p.name != key) continue;
    if (!(value >= p.min && value <= p.max))
      throw InputError(where, fmt::format("{} = {} is out of range for '{}'", key, value, f.name),
                       fmt::format("allowed: {} to {} ({})", p.min, p.max, p.meaning));
    if (p.integer && value != std::floor(value))
      throw InputError(where, fmt::format("{} = {} for '{}'", key, value, f.name),
                       fmt::format("a whole number from {} to {} ({})", p.min, p.max, p.meaning));
    scene.parameters[i] = value;
    return;
  }
  std::vector<std::string> known{"d"};
  for (const Parameter& p : f.parameters) known.push_back(p.name);
  for (const Choice& c : f.choices) known.push_back(c.name);
  throw unknown_name(where, fmt::format("parameter of '{}'", f.name), key, known);
}

// The place of the choice of this name, or none.
std::optional<std::size_t> find_choice(const Integrand& f, std::string_view key) {
  for (std::size_t i = 0; i < f.choices.size(); ++i)
    if (f.choices[i].name == key) return i;
  return std::nullopt;
}

void set_choice(Scene& scene, const Integrand& f, std::size_t i, std::string_view value,
                std::string_view where) {
  const Choice& choice = f.choices[i];
  if (std::find(choice.allowed.begin(), choice.allowed.end(), value) == choice.allowed.end())
    throw unknown_name(where, fmt::format("value of {} ({})", choice.name, choice.meaning), value,
                       choice.allowed);
  scene.choices[i] = value;
}

std::string canonical_text(const Scene& scene, const Integrand& f) {
  std::string text = fmt::format("{}:d={}", f.name, scene.dim);
  for (std::size_t i = 0; i < f.parameters.size(); ++i)
    if (scene.parameters[i] != f.parameters[i].default_value)
      text += fmt::format(",{}={}", f.parameters[i].name, scene.parameters[i]);
  for (std::size_t i = 0; i < f.choices.size(); ++i)
    if (scene.choices[i] != f.choices[i].default_value)
      text += fmt::format(",{}={}", f.choices[i].name, scene.choices[i]);
  return text;
}

}  // namespace

Scene scene_of(const Integrand& f, std::uint32_t dim, const Json& values) {
  Scene scene;
  scene.integrand = f.name;
  scene.dim = dim;
  for (const Parameter& p : f.parameters)
    scene.parameters.push_back(values.value(p.name, p.default_value));
  for (const Choice& c : f.choices) scene.choices.push_back(values.value(c.name, c.default_value));
  scene.text = canonical_text(scene, f);
  return scene;
}

Scene parse_scene(const Catalog& catalog, std::string_view text, std::string_view where) {
  const std::string_view name = text.substr(0, text.find(':'));
  const Integrand& f = catalog.integrand(name, where);
  Scene scene = scene_of(f, f.default_dim, Json::object());

  if (text.ends_with(':') || text.ends_with(','))
    throw InputError(where, fmt::format("'{}' ends with '{}'", text, text.back()),
                     "write NAME or NAME:key=value,key=value");
  std::vector<std::string_view> given;
  std::string_view rest =
      name.size() < text.size() ? text.substr(name.size() + 1) : std::string_view{};
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find(','));
    rest = pair.size() < rest.size() ? rest.substr(pair.size() + 1) : std::string_view{};
    const std::size_t equals = pair.find('=');
    const std::string_view key = pair.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? "" : pair.substr(equals + 1);
    if (std::find(given.begin(), given.end(), key) != given.end())
      throw InputError(where, fmt::format("'{}' is given twice", key), "give each key once");
    given.push_back(key);
    if (const auto choice = find_choice(f, key)) {
      set_choice(scene, f, *choice, value, where);
      continue;
    }
    const auto number = parse_value(value);
    if (!number)
      throw InputError(where, fmt::format("'{}' is no key=value with a number", pair),
                       "write NAME:key=value,key=value; a value is a number or a fraction a/b");
    if (key == "d")
      set_dimension(scene, f, *number, where);
    else
      set_parameter(scene, f, key, *number, where);
  }
  scene.text = canonical_text(scene, f);
  return scene;
}

}  // namespace koksma
