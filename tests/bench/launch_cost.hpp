// What a run costs besides its kernels: launches, the way to the first row, the default study.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace koksma::bench {

// launch_overhead/<precision>/<sampler>/log2_coordinates:L, N R d = 2^L with d = 8 and R = 32: one
// Integrator::run, from the call until its partial sums can be read on the host (arguments, launch,
// wait, mapping), over the kernel's time by its event, less 1: `overhead`, which must not be above
// `allowed`. `with_merge`: the same with the exact merge of the partial sums on the host, which is
// what the wall time of a result's row holds. Best of many rounds for each of the three times.
//
// launches_together/…: the same work as koksma times short rows (Integrator::times_together): 24
// launches of `runs` runs each, queued behind each other and waited for once: wall time over the
// sum of the kernels' times, less 1; `kernel_us` and `wall_us` are those of one run. `start`: the
// kernel's time of a run over that in launches of `longer_runs`, four times as many where they have
// room, less 1.
//
// first_row: seconds from the start of `koksma run` with one row until it has ended, which is after
// that row was printed and written; caches warm, best of nine; must be below `limit_s`.
//
// default_study: seconds of `koksma run` without arguments, the best of three with caches warm,
// below `limit_s`; `kernel_s` of all timed launches and `build_s` of all cells in that run: a miss
// unless the kernels take longer. `first_s`, `first_build_s`: of a run that finds no caches at all.
void register_launch_cost(std::vector<std::string>& missed);

}  // namespace koksma::bench
