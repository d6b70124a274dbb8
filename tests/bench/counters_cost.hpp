// What counters (KOKSMA_COUNTERS) cost on the cells of the default study: kernels with and without,
// alternating in one process.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace koksma::bench {

// Registers counters/<scene>/<sampler>, counter `slower`: kernel time over all N of the study with
// counters / without, less 1; and counters/default-study, the same of the sum over the cells that
// ran, which must not be above `allowed`, or it is appended to `missed`.
void register_counters_cost(std::vector<std::string>& missed);

}  // namespace koksma::bench
