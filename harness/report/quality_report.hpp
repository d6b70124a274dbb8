// What `koksma quality` prints: JSON after results/quality.schema.json, and a table.
#pragma once

#include <string>
#include <vector>

#include "plan/plan.hpp"
#include "quality/koksma_hlawka.hpp"

namespace koksma {

inline constexpr int kQualitySchemaVersion = 1;

struct QualityRequest {
  std::string sampler, precision, directions, command;
  std::uint32_t dim = 1, replicates = 1;
  std::uint64_t n = 1, seed = 1;
  std::vector<std::string> scenes;  // canonical spelling
};

// Checked against the schema. `plan` is that of the points.
Json quality_json(const QualityRequest& request, const Plan& plan, const DeviceFacts& device,
                  bool fp64_arithmetic, const Quality& quality,
                  const std::vector<KoksmaHlawka>& inequalities);

// The table of the terminal, from the JSON.
std::string quality_table(const Json& json);

}  // namespace koksma
