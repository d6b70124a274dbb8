// Point sets for the tests of the quality stage.
#pragma once

#include "quality/kernels.hpp"
#include "tests/support.hpp"

namespace koksma::test {

inline QualityKernels& quality_kernels() {
  static QualityKernels kernels(device(), true);
  return kernels;
}

// The generator of scripts/quality_reference.py: coordinates are multiples of 2^(shift - 64).
inline PointSet lcg_points(std::uint64_t n, std::uint32_t dim, std::uint64_t seed, int shift = 44) {
  PointSet set{dim, {}};
  for (std::uint64_t i = 0; i < n * dim; ++i) {
    seed = 6364136223846793005U * seed + 1442695040888963407U;
    set.x.push_back(static_cast<double>(seed >> shift) / static_cast<double>(1ULL << (64 - shift)));
  }
  return set;
}

inline PointSet drawn(const std::string& sampler, std::uint64_t n, std::uint32_t dim,
                      std::uint32_t replicate = 0) {
  return {dim, points({.sampler = sampler, .dim = dim, .count = n, .replicate = replicate})};
}

}  // namespace koksma::test
