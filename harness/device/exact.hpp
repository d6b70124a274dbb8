// Exact values of a scene and its coefficient table, computed in fp64 on a CPU device.
#pragma once

#include <optional>
#include <vector>

#include "device/device.hpp"

namespace koksma {

// The check of the integrand's entry that has this dimension and these parameters, nullptr if there
// is none.
const Json* matching_check(const Integrand& integrand, const Scene& scene);

struct ExactValues {
  std::optional<double> mean, variance, mean_abs;
  std::optional<double> variation;  // of Hardy and Krause, anchored at 1
  bool infinite_variance = false;   // known to be infinite; `variance` is then empty
  bool variance_overflows = false;  // finite, but above the range of double; also empty
  bool mean_undefined = false;      // f has no mean; `mean` is then empty
  // Of the numerical solution, where f solves a differential equation and they are known.
  std::optional<double> discrete_mean, discrete_variance, discrete_mean_abs;
  // One of them is finite, but above the range of double.
  bool discrete_overflows = false;
  std::optional<double> bound;       // sup |f| of the true solution
  std::optional<double> stiffness;   // largest h |λ|, h the solver's step
  std::vector<double> coefficients;  // [dimension][coefficient]
  // Which dimension of the points the k-th draw takes, a permutation; empty: the k-th.
  std::vector<std::uint32_t> dimension_order;
};

// |f| above which a sample means that f was not computed: 10 times the bound of the true solution
// of a differential equation, 1e30 E|f| (5-numerics 0); infinity where neither is known.
double blow_up_limit(const ExactValues& exact);

// Runs the integrand's exact program. Quantities that the entry says do not exist stay empty;
// infinite ones too. "table" entries are looked up among the entry's checks (same d and
// parameters).
ExactValues compute_exact(Device& device, const Integrand& integrand, const Scene& scene);

}  // namespace koksma
