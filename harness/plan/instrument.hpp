// Puts a count beside every statement of a composed program, so that running it tells how many
// operations it takes: nothing is estimated, and loops and branches count as often as they are
// taken. Of `a && b` and `a ? b : c` all operands count. The values that the program computes stay
// what they are.
#pragma once

#include <string>
#include <vector>

#include "plan/plan.hpp"

namespace koksma {

// Slots that operations are counted for, in the order of the kernel's output.
inline constexpr const char* kCountedSlots[] = {"points", "integrand", "sum", "seek"};

struct InstrumentedProgram {
  ProgramSource source;  // kernel count_operations of kernels/counting/count.cl
  // Names of what is counted: [0] operations on scalars that all lanes share, [1] elements of
  // arrays that are read or written as scalars; then operations on vectors. Counter [slot][name].
  std::vector<std::string> operations;
};

// UnsupportedError, with the place, for a statement that it can not read.
InstrumentedProgram counting_operations(const Catalog& catalog, const Plan& plan);

// The text with its counts alone; `operations` receives names that are new to it.
std::string instrumented(const std::string& text, std::vector<std::string>& operations);

}  // namespace koksma
