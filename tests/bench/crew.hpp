// One pinned thread on each processor for the life of the program, as an OpenCL implementation
// keeps them: on a busy machine threads left alone can share one processor for seconds.
#pragma once

#include <cstdint>
#include <functional>

namespace koksma::bench {

// Calls work(unit) for units 0 ... units - 1, handed out one by one as threads come free. Returns
// the seconds from the first thread's start to the last one's end.
double run_on_crew(std::uint64_t units, const std::function<void(std::uint64_t)>& work);

}  // namespace koksma::bench
