#include "quality/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace koksma {
namespace {

constexpr std::uint32_t kBins = 128, kBinsPerSpacing = 16;
constexpr std::uint32_t kHistogramItems = 64;
constexpr std::uint32_t kLargestReach = 512;

// P of one set, [kx][ky + reach], kx = 0 ... reach.
std::vector<double> half_spectrum(QualityKernels& kernels, const PointSet& points,
                                  std::uint32_t reach) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::uint32_t row = kernels.padded(2 * reach + 1), blocks = row / kernels.lanes();
  const std::uint64_t values = std::uint64_t{reach + 1} * row;
  const cl::Buffer out = kernels.scalars(values);
  kernels.run("spectrum", "power_spectrum", reach + 1, kernels.columns(points, 0.0),
              kernels.padded(n), n, reach, blocks, kernels.scalars(2 * values), out);
  const std::vector<double> all = kernels.read(out, values);
  std::vector<double> result;
  for (std::uint32_t kx = 0; kx <= reach; ++kx) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(kx) * row;
    result.insert(result.end(), begin, begin + 2 * static_cast<std::ptrdiff_t>(reach) + 1);
  }
  return result;
}

// Spectra that are kept to tell repeated sets; shifted tables have one, random sets are all
// different.
constexpr std::size_t kMostCompared = 64;

// Equal up to the rounding of a spectrum in single precision.
bool same_spectrum(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [](double p, double q) { return std::fabs(p - q) <= 1e-2 * (1 + p); });
}

// Calls take(|k|, P(k)) for the frequencies of one half plane, without 0: the others are equal.
template <typename Take>
void each_independent(const PowerSpectrum& s, Take&& take) {
  const auto reach = static_cast<std::int64_t>(s.reach);
  const auto width = static_cast<std::size_t>(2 * reach + 1);
  for (std::int64_t kx = 0; kx <= reach; ++kx)
    for (std::int64_t ky = kx == 0 ? 1 : -reach; ky <= reach; ++ky)
      take(std::hypot(kx, ky), s.power[static_cast<std::size_t>(kx + reach) * width +
                                       static_cast<std::size_t>(ky + reach)]);
}

// A frequency that a set has not at all comes out at the rounding error of N phases, some 64 eps
// each: that is 0.
void clear_rounding(PowerSpectrum& s, std::uint64_t n, bool fp64) {
  const double error = 64 * (fp64 ? 0x1p-53 : 0x1p-24);
  for (double& p : s.power)
    if (p < static_cast<double>(n) * error * error) p = 0;
}

void add_radial_statistics(PowerSpectrum& s) {
  std::vector<double> count(s.reach + 1, 0.0), squares(s.reach + 1, 0.0);
  s.radial_mean.assign(s.reach + 1, 0.0);
  const auto ring = [&](double frequency) {
    return static_cast<std::size_t>(std::lround(frequency));
  };
  each_independent(s, [&](double frequency, double power) {
    if (ring(frequency) > s.reach) return;
    count[ring(frequency)] += 1;
    s.radial_mean[ring(frequency)] += power;
  });
  for (std::size_t r = 1; r <= s.reach; ++r) s.radial_mean[r] /= count[r];
  each_independent(s, [&](double frequency, double power) {
    if (ring(frequency) > s.reach) return;
    const double excess = power - s.radial_mean[ring(frequency)];
    squares[ring(frequency)] += excess * excess;
  });
  for (std::size_t r = 1; r <= s.reach; ++r) {
    const double ratio = squares[r] / (count[r] - 1) / (s.radial_mean[r] * s.radial_mean[r]);
    s.anisotropy_db.push_back(
        ratio > 0 && std::isfinite(ratio) ? std::optional(10 * std::log10(ratio)) : std::nullopt);
  }
  s.radial_mean.erase(s.radial_mean.begin());  // rings 1 ... reach
}

void add_low_frequencies(PowerSpectrum& s) {
  const auto peak = std::max_element(s.radial_mean.begin(), s.radial_mean.end());
  s.peak_frequency = static_cast<double>(peak - s.radial_mean.begin() + 1);
  double sum = 0, count = 0;
  each_independent(s, [&](double frequency, double power) {
    if (frequency >= s.peak_frequency / 4) return;
    sum += power;
    count += 1;
  });
  if (count > 0) s.low_frequency_power = sum / count;
}

}  // namespace

PairCorrelation pair_correlation(QualityKernels& kernels, const std::vector<PointSet>& sets) {
  const auto n = static_cast<std::uint32_t>(sets.front().size());
  // Eight mean spacings, or half the torus, where rings stop being whole.
  PairCorrelation result;
  result.bin_width =
      std::min(1 / (kBinsPerSpacing * std::sqrt(static_cast<double>(n))), 0.5 / kBins);
  std::vector<double> pairs(kBins, 0.0);
  for (const PointSet& points : sets) {
    const std::uint32_t cells = kHistogramItems * kBins;
    const cl::Buffer out = kernels.device().allocate(cells * sizeof(cl_uint));
    kernels.run("pairs", "pair_histogram", kHistogramItems, kernels.columns(points, 0.0),
                kernels.padded(n), n, kHistogramItems, kBins,
                kernels.upload(std::vector<double>{1 / result.bin_width}), out);
    const std::vector<std::uint32_t> counts = kernels.read_words(out, cells);
    for (std::uint32_t c = 0; c < cells; ++c) pairs[c % kBins] += counts[c];
  }
  const double all_pairs = 0.5 * n * (n - 1.0) * static_cast<double>(sets.size());
  for (std::uint32_t b = 0; b < kBins; ++b) {
    const double ring = std::numbers::pi * result.bin_width * result.bin_width * (2.0 * b + 1);
    result.radius.push_back((b + 0.5) * result.bin_width);
    result.value.push_back(pairs[b] / (all_pairs * ring));
  }
  return result;
}

std::uint32_t spectrum_reach(std::uint64_t n) {
  const double twice = std::ceil(2 * std::sqrt(static_cast<double>(n)));
  return static_cast<std::uint32_t>(std::clamp<double>(twice, 4, kLargestReach));
}

PowerSpectrum power_spectrum(QualityKernels& kernels, const std::vector<PointSet>& sets,
                             std::uint32_t reach) {
  PowerSpectrum result;
  result.reach = reach;
  const std::size_t width = 2 * std::size_t{reach} + 1;
  result.power.assign(width * width, 0.0);
  std::vector<std::vector<double>> distinct;
  for (const PointSet& points : sets) {
    std::vector<double> half = half_spectrum(kernels, points, reach);
    const bool known = std::any_of(distinct.begin(), distinct.end(),
                                   [&](const auto& other) { return same_spectrum(other, half); });
    result.distinct_sets += known ? 0 : 1;
    for (std::size_t i = 0; i < half.size(); ++i) result.power[reach * width + i] += half[i];
    if (!known && distinct.size() < kMostCompared) distinct.push_back(std::move(half));
  }
  // P(-k) = P(k): the lower half is the upper one read backwards.
  for (std::size_t i = 0; i < width * width / 2; ++i)
    result.power[i] = result.power[width * width - 1 - i];
  for (double& p : result.power) p /= static_cast<double>(sets.size());
  clear_rounding(result, sets.front().size(), kernels.fp64());
  add_radial_statistics(result);
  add_low_frequencies(result);
  return result;
}

}  // namespace koksma
