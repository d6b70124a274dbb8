// Columns of text for the terminal.
#pragma once

#include <string>
#include <vector>

namespace koksma {

// Lines of equal length, the first a heading; columns are padded to their widest, but the last runs
// on. UTF-8.
std::string text_table(const std::vector<std::vector<std::string>>& lines);

}  // namespace koksma
