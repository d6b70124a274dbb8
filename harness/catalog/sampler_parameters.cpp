#include "catalog/sampler_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "error/error.hpp"

namespace koksma {
namespace {

constexpr std::string_view kRandomize = "randomize";
constexpr std::string_view kRotate = "rotate";

// Point i of replicate r is x_i + u_r mod 1, u_r uniform: unbiased whatever the set.
void rotate(Sampler& s) {
  s.rotated = true;
  s.centred = true;
  s.replicable = true;
  s.validity = {"unbiased_replicates"};
  s.default_estimator = "rqmc";
  s.rate_class = s.rotated_rate_class;
  s.properties.clear();
  s.known_answers = Json::array();
  s.title += ", every coordinate shifted at random modulo 1 (Cranley and Patterson 1976)";
}

std::vector<std::string> known_keys(const Sampler& s) {
  std::vector<std::string> keys;
  for (const SamplerParameter& p : s.parameters) keys.push_back(p.name);
  if (!s.replicable) keys.emplace_back(kRandomize);
  return keys;
}

void refuse_value(std::string_view where, std::string_view key, std::string_view value,
                  const std::vector<std::string>& allowed) {
  throw InputError(where, fmt::format("{} = '{}'", key, value),
                   fmt::format("allowed: {}", fmt::join(allowed, ", ")));
}

void set_one(Sampler& s, const std::string& name, const std::string& key, const std::string& value,
             std::string_view where) {
  const auto keys = known_keys(s);
  if (std::find(keys.begin(), keys.end(), key) == keys.end())
    throw keys.empty()
        ? InputError(where, fmt::format("sampler '{}' with '{}'", name, key),
                     "it takes no parameters")
        : unknown_name(where, fmt::format("parameter of sampler '{}'", name), key, keys);
  if (key == kRandomize) {
    if (value != kRotate) refuse_value(where, key, value, {std::string(kRotate)});
    return rotate(s);
  }
  const auto p = std::find_if(s.parameters.begin(), s.parameters.end(),
                              [&](const SamplerParameter& each) { return each.name == key; });
  if (!p->allowed.empty() &&
      std::find(p->allowed.begin(), p->allowed.end(), value) == p->allowed.end())
    refuse_value(where, key, value, p->allowed);
  s.options[key] = value;
}

}  // namespace

void set_parameters(Sampler& sampler, std::string_view text, std::string_view where) {
  const std::string name = sampler.name;
  std::vector<std::pair<std::string, std::string>> given;
  std::string_view rest = text.empty() ? text : text.substr(1);
  if (text == ":" || text.ends_with(','))
    throw InputError(where, fmt::format("'{}{}' ends with '{}'", name, text, text.back()),
                     "write NAME or NAME:key=value,key=value");
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find(','));
    rest = pair.size() < rest.size() ? rest.substr(pair.size() + 1) : std::string_view{};
    const std::size_t equals = pair.find('=');
    if (equals == std::string_view::npos || equals + 1 == pair.size())
      throw InputError(where, fmt::format("'{}' is no key=value", pair),
                       fmt::format("write {}:key=value,key=value", name));
    const std::string key(pair.substr(0, equals));
    for (const auto& [earlier, ignored] : given)
      if (earlier == key)
        throw InputError(where, fmt::format("'{}' is given twice", key), "give each key once");
    given.emplace_back(key, pair.substr(equals + 1));
    set_one(sampler, name, key, given.back().second, where);
  }
  for (const SamplerParameter& p : sampler.parameters)
    if (p.required && !sampler.options.contains(p.name))
      throw InputError(where, fmt::format("sampler '{}' without '{}'", name, p.name),
                       fmt::format("write {}:{}=… ({})", name, p.name, p.meaning));
  std::sort(given.begin(), given.end());
  for (std::size_t i = 0; i < given.size(); ++i)
    sampler.name += fmt::format("{}{}={}", i == 0 ? ':' : ',', given[i].first, given[i].second);
}

}  // namespace koksma
