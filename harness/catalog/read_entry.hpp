// Turns schema-checked JSON entries into the catalog's structs.
#pragma once

#include <string>
#include <string_view>

#include "catalog/catalog.hpp"
#include "catalog/json.hpp"

namespace koksma {

Sampler read_sampler(const Json& entry, const std::string& family);
SumAlgorithm read_sum(const Json& entry, SourceFile code);
Solver read_solver(const Json& entry, SourceFile code);
Estimator read_estimator(const Json& entry);
// `classes` is integrands/classes.json; InputError (naming `where`) for a class it does not hold.
Integrand read_integrand(const Json& entry, const Json& classes, std::string_view where,
                         SourceFile code);

}  // namespace koksma
