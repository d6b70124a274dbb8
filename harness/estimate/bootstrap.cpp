#include "estimate/bootstrap.hpp"

#include <algorithm>
#include <cmath>

namespace koksma {

namespace {

constexpr std::size_t kFewestValues = 20;

// Linear interpolation between order statistics (type 7 of Hyndman & Fan, Am. Stat. 50, 1996).
double quantile(std::span<const double> sorted, double probability) {
  const double rank = probability * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(rank));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], rank - static_cast<double>(below));
}

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
  return Interval{quantile(values, kIntervalTail), quantile(values, 1 - kIntervalTail)};
}

}  // namespace koksma
