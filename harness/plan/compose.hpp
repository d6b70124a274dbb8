// Puts kernel pieces together in the order of kernels/README.md.
#pragma once

#include "plan/plan.hpp"

namespace koksma {

enum class ProgramKind { integrate, count_nonfinite, inspect, inspect_scene };

ProgramSource compose(const Catalog& catalog, const Plan& plan, ProgramKind kind);

}  // namespace koksma
