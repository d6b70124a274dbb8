// What `koksma compare` prints and writes: a table for the terminal, Markdown for a pull request,
// JSON after results/compare.schema.json.
#pragma once

#include <string>

#include "report/compare.hpp"

namespace koksma {

inline constexpr int kCompareSchemaVersion = 2;

// Differences of the runs, a line per cell, a line per row that changed, the verdict. UTF-8.
std::string compare_table(const Comparison& comparison);

// The same as Markdown: the verdict first, cells that did not change folded away.
std::string compare_markdown(const Comparison& comparison);

// Checked against the schema.
Json compare_json(const Comparison& comparison);

}  // namespace koksma
