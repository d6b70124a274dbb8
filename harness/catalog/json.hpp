// Reading and checking JSON: every complaint names the file, the place (line or JSON pointer), what
// was found and what is allowed.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace koksma {

using Json = nlohmann::ordered_json;

// Whole file as text; InputError if it cannot be read.
std::string read_text_file(const std::string& path);

// Parses `text`; InputError with line and column of `where` on malformed JSON.
Json parse_json(std::string_view text, std::string_view where);

// JSON text. Bytes that are no UTF-8 (of paths, compiler logs, drivers) are replaced rather than
// thrown about.
std::string dumped(const Json& value, int indent = -1);

// Checks `value` against an embedded JSON Schema (draft 7), e.g. "harness/study/study.schema.json".
// InputError naming `where` and the JSON pointer; an unknown key comes with the nearest known one.
void check_schema(const Json& value, std::string_view schema_path, std::string_view where);

}  // namespace koksma
