// The harness's kernels beside their hand-written limits (avx2_limits.hpp), alternating in one
// process.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace koksma::bench {

// Registers ratio/<name>. Counters: `ratio`, the kernel's coordinates/s over the limit's, both in
// their fastest round; `required`: a ratio below it is appended to `missed`, and so is a mean that
// is not the limit's; `processor_ratio`: the same of the processors' time of all rounds, host side
// included, which is steadier on a busy machine; `kernel/s`, `limit/s`; `avx512`: 1 where the
// processor has AVX-512, which the device's compiler may use and the limits do not.
void register_ratio_rows(std::vector<std::string>& missed);

}  // namespace koksma::bench
