#include "estimate/bootstrap.hpp"

#include <algorithm>

#include "estimate/quantile.hpp"

namespace koksma {

namespace {

constexpr std::size_t kFewestValues = 20;

}  // namespace

std::uint64_t SplitMix64::next() {
  state_ += 0x9e3779b97f4a7c15U;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

void draw_counts(SplitMix64& generator, std::span<std::uint32_t> counts) {
  std::fill(counts.begin(), counts.end(), 0U);
  for (std::size_t r = 0; r < counts.size(); ++r) ++counts[generator.index(counts.size())];
}

std::optional<Interval> percentile_interval(std::span<double> values) {
  if (values.size() < kFewestValues) return std::nullopt;
  std::sort(values.begin(), values.end());
  return Interval{quantile_of(values, kIntervalTail), quantile_of(values, 1 - kIntervalTail)};
}

}  // namespace koksma
