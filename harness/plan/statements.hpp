// Statements of OpenCL C: where counts of their operations can stand.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "plan/expressions.hpp"

namespace koksma {

// Text that goes in at `at`: an opening brace, counts, a closing brace.
struct StatementCounts {
  std::size_t at = 0;
  std::vector<Counted> counted;
  bool opens = false, closes = false;
};

// Of the compound statement between the braces tokens[begin] and tokens[end] of `code`, in an order
// in which those of one place can be put in one after the other.
std::vector<StatementCounts> statement_counts(std::string_view code,
                                              const std::vector<Token>& tokens, std::size_t begin,
                                              std::size_t end, const ProgramNames& names);

}  // namespace koksma
