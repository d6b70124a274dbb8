// Expressions of OpenCL C, read as far as counting their operations takes. Names and types are the
// program's own.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "plan/tokens.hpp"

namespace koksma {

struct Macro {
  std::vector<std::string> parameters;
  std::string body;
};

struct ProgramNames {
  std::set<std::string> calls;          // functions that the program defines
  std::set<std::string> types;          // that it defines
  std::map<std::string, Macro> macros;  // function-like ones that are expanded to be counted
};

// One operation; `expression` has its type and names nothing that is out of scope where the count
// stands. Empty: it has no value.
struct Counted {
  std::string operation, expression;
};

using Counts = std::vector<Counted>;

bool is_type(const std::string& name, const std::set<std::string>& types);

// Reads the expression that begins at tokens[at], as far as it goes but not beyond `end`; with
// `initialiser` what may stand behind `=`, no comma operator and perhaps braces. Appends its
// operations and returns the place of the token behind it. UnsupportedError with the place where it
// is none. Operations have a name for C's signs ("add", "bitwise", …) or a built-in's; "element" is
// a subscript.
std::size_t read_expression(std::string_view code, const std::vector<Token>& tokens, std::size_t at,
                            std::size_t end, const ProgramNames& names, Counts& counts,
                            bool initialiser);

}  // namespace koksma
