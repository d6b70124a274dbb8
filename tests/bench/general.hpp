// Planned kernels beside general ones: what leaving out is worth.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace koksma::bench {

// Registers planned_vs_general/<scene>/<sampler>/n:<N>. Counters: `ratio`, general time / planned
// time; `required`, less of it is appended to `missed`: 0.97 everywhere (never slower, within what
// the fastest of many rounds still scatters by) and 1.5 where coordinates dominate, that is where
// the planned kernel takes more operations to make a coordinate than to use it, as counted; the
// counts.
void register_planned_vs_general(std::vector<std::string>& missed);

}  // namespace koksma::bench
