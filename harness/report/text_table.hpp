// Columns of text for the terminal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "catalog/json.hpp"

namespace koksma {

// Lines of equal length, the first a heading; columns are padded to their widest, but the last runs
// on. UTF-8.
std::string text_table(const std::vector<std::vector<std::string>>& lines);

// "2^10" or "1000".
std::string size_text(std::uint64_t n);

// The number in fmt's `format`; "-" where the value is none.
std::string number_text(const Json& value, const char* format = "{:.2e}");

}  // namespace koksma
