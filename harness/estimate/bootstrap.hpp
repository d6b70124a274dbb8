// Resampling of replicates with a fixed, documented seed: the same data always give the same
// interval.
//
// Generator: SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number
// generators, OOPSLA 2014, fig. 11 with the constants of variant 13 of D. Stafford). Interval:
// percentile bootstrap (B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap, 1993,
// section 13.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "estimate/interval.hpp"

namespace koksma {

// The seed of every bootstrap of the harness: the first 64 bits of the fraction of the golden
// ratio.
inline constexpr std::uint64_t kBootstrapSeed = 0x9e3779b97f4a7c15U;
inline constexpr std::size_t kBootstrapResamples = 1000;

class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next();

  // An index in [0, size), size < 2^32; the bias is below size·2^-32.
  std::size_t index(std::size_t size) {
    return static_cast<std::size_t>(((next() >> 32U) * size) >> 32U);
  }

 private:
  std::uint64_t state_;
};

// How often each of the R replicates occurs in one resample of size R: overwrites `counts`, whose
// size is R.
void draw_counts(SplitMix64& generator, std::span<std::uint32_t> counts);

// The middle 95 % of the resampled values; finite values only, reordered in place. None below 20
// values.
std::optional<Interval> percentile_interval(std::span<double> values);

}  // namespace koksma
