// What `koksma stability` prints and writes: a table of cases and checks, and JSON after
// results/stability.schema.json.
#pragma once

#include <string>
#include <vector>

#include "plan/plan.hpp"
#include "stability/device_checks.hpp"
#include "stability/suite_run.hpp"

namespace koksma {

inline constexpr int kStabilitySchemaVersion = 1;

// {schema_version, context, device_checks, cases, floors, seconds}, checked against the schema;
// cells also against that of results.
Json stability_json(const Json& context, const DeviceChecks& checks,
                    const std::vector<CaseOutcome>& outcomes, double seconds);

// The terminal's view, from the JSON: a line per case, why demands are not met, floors, the checks
// of the device.
std::string stability_table(const Json& json);

// Every case got its verdict and every check of the device that must hold does.
bool all_met(const Json& json);

}  // namespace koksma
