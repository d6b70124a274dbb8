// A planned kernel beside its general twin (plan/general.hpp): both times and whether the estimates
// agree. The two alternate in one process and each time is the fastest of all rounds, so that their
// ratio stands on a machine that is disturbed.
#pragma once

#include <cstdint>

#include "device/device.hpp"
#include "plan/plan.hpp"

namespace koksma {

struct GeneralComparison {
  double planned_s = 0, general_s = 0;  // kernels by the device's clock, of all replicates
  std::size_t rounds = 0;
  bool settled = false;             // both times were met three times within 2 %
  double planned = 0, general = 0;  // estimates: means over all samples of all replicates
  double allowed = 0;               // between them: rounding of f and of its sum
  std::size_t planned_table = 0, general_table = 0;  // bytes

  // Above 1: the planned kernel is faster.
  double ratio() const { return general_s / planned_s; }
};

// How long to go on: at least `least` rounds and `least_seconds`, then until both are settled,
// `most` rounds or `seconds` have passed.
struct Rounds {
  std::size_t least = 31, most = 2000;
  double least_seconds = 0, seconds = 10;
};

// Integrates the first n samples of every replicate with both kernels. UnsupportedError where the
// plan has no general kernel; std::runtime_error where the estimates differ by more than `allowed`:
// then one of the kernels is wrong. `coefficients` as for Integrator.
GeneralComparison compare_with_general(Device& device, const Catalog& catalog, const Plan& plan,
                                       const std::vector<double>& coefficients, std::uint64_t n,
                                       const Rounds& rounds = {});

}  // namespace koksma
