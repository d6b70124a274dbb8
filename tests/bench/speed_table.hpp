// The speed table: coordinates/s of every sampler of the catalog beside plain Sobol' points of the
// same precision and dimension, alternating in one process.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

namespace koksma::bench {

// Registers speed/<sampler>/<precision>/d:<D> for D = 2, 8, 64. Counters: coordinates/s, ratio to
// plain Sobol', and `required` where the sampler's entry declares one; what is below it is appended
// to `missed`.
void register_speed_table(std::vector<std::string>& missed);

}  // namespace koksma::bench
