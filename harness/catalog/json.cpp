#include "catalog/json.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "catalog/embedded.hpp"
#include "error/error.hpp"

namespace koksma {
namespace {

using PlainJson = nlohmann::json;  // valijson's adapter is written for the unordered type

const PlainJson& resolve(const PlainJson& schema, const PlainJson& root) {
  const auto reference = schema.find("$ref");
  if (reference == schema.end()) return schema;
  return root.at(PlainJson::json_pointer(reference->get<std::string>().substr(1)));
}

// Unknown keys are told here rather than by the validator, which would not suggest a spelling.
void check_keys(const PlainJson& value, const PlainJson& unresolved, const PlainJson& root,
                const std::string& pointer, std::string_view where) {
  const PlainJson& schema = resolve(unresolved, root);
  if (value.is_array() && schema.contains("items")) {
    for (std::size_t i = 0; i < value.size(); ++i)
      check_keys(value[i], schema["items"], root, fmt::format("{}/{}", pointer, i), where);
  }
  if (value.is_object() && schema.contains("patternProperties")) {
    // Names chosen by the user: the validator checks them, the values all follow the one pattern.
    for (const auto& [key, inner] : value.items())
      check_keys(inner, schema["patternProperties"].front(), root, pointer + "/" + key, where);
    return;
  }
  if (!value.is_object() || !schema.contains("properties")) return;
  const PlainJson& properties = schema["properties"];
  const bool closed = schema.value("additionalProperties", PlainJson(true)) == PlainJson(false);
  for (const auto& [key, inner] : value.items()) {
    const auto known = properties.find(key);
    if (known != properties.end()) {
      check_keys(inner, *known, root, pointer + "/" + key, where);
    } else if (closed) {
      std::vector<std::string> names;
      for (const auto& [name, ignored] : properties.items()) names.push_back(name);
      throw unknown_name(fmt::format("{}, at '{}/{}'", where, pointer, key), "key", key, names);
    }
  }
}

std::string pointer_of(const std::vector<std::string>& context) {
  std::string pointer;
  for (const std::string& step : context) {
    if (step == "<root>") continue;
    const bool bracketed = step.size() >= 2 && step.front() == '[' && step.back() == ']';
    pointer += "/" + (bracketed ? step.substr(1, step.size() - 2) : step);
  }
  return pointer;
}

}  // namespace

std::string read_text_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw InputError(path, "the file cannot be read", "give the path of a readable file");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string dumped(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json parse_json(std::string_view text, std::string_view where) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw InputError(where, fmt::format("malformed JSON: {}", error.what()), "");
  }
}

void check_schema(const Json& value, std::string_view schema_path, std::string_view where) {
  const PlainJson schema_json = PlainJson::parse(embedded_text(schema_path));
  const PlainJson plain = PlainJson::parse(dumped(value));
  check_keys(plain, schema_json, schema_json, "", where);

  valijson::Schema schema;
  valijson::SchemaParser parser;
  const valijson::adapters::NlohmannJsonAdapter schema_adapter(schema_json);
  parser.populateSchema(schema_adapter, schema);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(plain), &results)) return;

  // The last error is the outermost one and says least; the first has the deepest place.
  valijson::ValidationResults::Error error;
  results.popError(error);
  const std::string pointer = pointer_of(error.context);
  std::string found;
  try {
    found = plain.at(PlainJson::json_pointer(pointer)).dump();
    if (found.size() > 80) found = found.substr(0, 77) + "...";
  } catch (const PlainJson::exception&) {
    found = "";
  }
  throw InputError(fmt::format("{}, at '{}'", where, pointer),
                   found.empty() ? "invalid value" : "found " + found,
                   fmt::format("{} ({})", error.description, schema_path));
}

}  // namespace koksma
