// The conditional directives of a program in OpenCL C, decided as far as the text alone decides
// them (C99, 6.10.1).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace koksma {

// A line of the program and where it comes from.
struct SourceLine {
  std::string_view text;  // without its line feed
  std::string path;       // of the piece; empty before the first
  std::size_t number = 1;
};

// The lines of `text` with the places that `#line 1 "<path>"` gives them; those directives are not
// among them.
std::vector<SourceLine> source_lines(std::string_view text);

// What is left once every branch that is known to be closed is gone, with the directives that were
// decided. A condition is known where it consists of integers, operators, `defined` and KOKSMA_*
// names, each of them undefined or defined as a known expression; a directive it cannot parse is
// not known.
std::vector<SourceLine> open_lines(const std::vector<SourceLine>& lines);

// The directive of a line ("if", "define", …) or nothing.
std::string_view directive_of(std::string_view line);

// The rest of the line behind the directive, without a // comment.
std::string_view operand_of(std::string_view line);

// Bodies of macros by name; nullopt: defined or not, the text alone does not tell.
using Macros = std::map<std::string, std::optional<std::string>, std::less<>>;

// The value of a condition, nullopt where it is not known.
std::optional<long long> condition_value(std::string_view condition, const Macros& macros);

}  // namespace koksma
