// What the device checks integrate instead of a catalog's integrand: terms that are known, and
// sample indices. They go through make_plan, the integration kernel and the integrator as
// everything does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "study/study.hpp"

namespace koksma {

// The catalog with the integrand `terms`, and with the points, the sum and the integrand `indices`,
// of kernels/stability/. `koksma list` never sees them.
Catalog with_terms(const Catalog& catalog);
Catalog with_indices(const Catalog& catalog);

// Terms offset + slope x ± swing, the sign at random, or their absolute values.
struct Terms {
  std::string name;
  double offset = 0, slope = 0, swing = 0;

  bool constant() const { return slope == 0 && swing == 0; }
  // Values of the specimen's parameters.
  std::vector<double> parameters(bool absolute = false) const {
    return {offset, slope, swing, absolute ? 1.0 : 0.0};
  }
};

// N of these terms at independent random points, one replicate, one moment.
Cell terms_cell(const Catalog& with_terms, const std::string& sum, Precision precision,
                std::uint64_t n);

// A cell whose samples are their own indices, summed by the four words of kernels/stability/
// index-sums.cl.
Cell index_cell(const Catalog& with_indices, std::uint64_t n);

// As the device mixes an index.
std::uint64_t index_mix(std::uint64_t i);

}  // namespace koksma
