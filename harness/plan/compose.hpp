// Puts kernel pieces together in the order of kernels/README.md.
#pragma once

#include "plan/plan.hpp"

namespace koksma {

enum class ProgramKind { integrate, inspect, inspect_scene, general, count };

// The integrand with everything that belongs to it: what its scene chose, parameters, solver,
// parts, its own code.
void append_integrand(std::string& text, const Catalog& catalog, const Integrand& f,
                      const Scene& scene);

// `#define KOKSMA_<CHOICE>_<VALUE> 1` for each choice of the scene.
std::string choices_source(const Integrand& f, const Scene& scene);

// struct params of this number type and its loader, from the entry's parameters.
std::string params_source(const Integrand& f, const char* type);

// The piece that comes before a program whose operations are counted (plan/instrument.hpp).
std::string counting_types();

// The pieces as they are written for every plan.
ProgramSource compose_whole(const Catalog& catalog, const Plan& plan, ProgramKind kind);

// Without what this plan can not reach (prune.hpp).
ProgramSource compose(const Catalog& catalog, const Plan& plan, ProgramKind kind);

// The kernels of kernels/points/prepare/<piece>.cl, after the family's parts. The local size is
// among the options, so that the text alone tells what is computed.
ProgramSource compose_preparation(const Family& family, const std::string& piece,
                                  std::uint32_t local_size);

}  // namespace koksma
