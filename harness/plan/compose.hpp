// Puts kernel pieces together in the order of kernels/README.md.
#pragma once

#include "plan/plan.hpp"

namespace koksma {

enum class ProgramKind { integrate, inspect, inspect_scene };

// struct params of this number type and its loader, from the entry's parameters.
std::string params_source(const Integrand& f, const char* type);

ProgramSource compose(const Catalog& catalog, const Plan& plan, ProgramKind kind);

// The kernels of kernels/points/prepare/<piece>.cl, after the family's parts. The local size is
// among the options, so that the text alone tells what is computed.
ProgramSource compose_preparation(const Family& family, const std::string& piece,
                                  std::uint32_t local_size);

}  // namespace koksma
