// The results file: context and cells, checked against results/results.schema.json before it is
// written.
#pragma once

#include <string>

#include "journal/cell_json.hpp"
#include "plan/plan.hpp"
#include "study/study.hpp"

namespace koksma {

inline constexpr int kResultsSchemaVersion = 4;

// version, revision, date (UTC), host, device and driver, build, seed, command line, the study
// verbatim.
Json make_context(const DeviceFacts& device, const Study& study, const std::string& command_line);

// What must be equal for cells of an earlier run to be taken over.
Json resume_context(const Json& context);

// {schema_version, context, cells, scenes}, the cells compared with each other.
Json make_results(const Json& context, const Json& cells);

// Scene, sampler, estimator, precision ("-": not known) and sum of a cell in results.
std::string cell_name(const Json& cell, char between);

// Checks and writes; InputError when the path cannot be written or the
// schema does not hold.
void write_results(const Json& results, const std::string& path);

}  // namespace koksma
