// Spectra and pair correlations: white noise is flat, grids are made of peaks, blue noise has
// little power near zero frequency.
#include <Random123/philox.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "quality/spectrum.hpp"
#include "tests/quality_support.hpp"

using namespace koksma;
using test::drawn;
using test::quality_kernels;

namespace {

std::vector<PointSet> white_noise(std::uint64_t n, std::uint32_t sets) {
  std::vector<PointSet> result;
  for (std::uint32_t r = 0; r < sets; ++r) result.push_back(drawn("random", n, 2, r));
  return result;
}

PointSet grid(std::uint32_t side) {
  PointSet set{2, {}};
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t k = 0; k < side; ++k) {
      set.x.push_back((k + 0.5) / side);
      set.x.push_back((i + 0.5) / side);
    }
  return set;
}

// Dart throwing on the torus: a point is kept when it is far from all before.
PointSet dart_throwing(std::uint32_t n, double distance, std::uint64_t seed) {
  PointSet set{2, {}};
  for (std::uint32_t attempt = 0; set.size() < n; ++attempt) {
    REQUIRE(attempt < 1000000);
    const r123::Philox4x32 philox;
    const auto word = philox({{attempt, 0, 0, 0}}, {{static_cast<std::uint32_t>(seed), 77}});
    const double x = word[0] * 0x1p-32, y = word[1] * 0x1p-32;
    bool far = true;
    for (std::uint64_t i = 0; i < set.size() && far; ++i) {
      const double gx = std::fabs(x - set.at(i, 0)), gy = std::fabs(y - set.at(i, 1));
      far = std::hypot(std::min(gx, 1 - gx), std::min(gy, 1 - gy)) >= distance;
    }
    if (!far) continue;
    set.x.push_back(x);
    set.x.push_back(y);
  }
  return set;
}

PowerSpectrum spectrum_of(const std::vector<PointSet>& sets) {
  return power_spectrum(quality_kernels(), sets, spectrum_reach(sets.front().size()));
}

}  // namespace

TEST_CASE("the power spectrum is the periodogram, at every frequency and its negative",
          "[device]") {
  const PointSet p = test::lcg_points(37, 2, 4);
  const std::uint32_t reach = 21;
  const PowerSpectrum s = power_spectrum(quality_kernels(), {p}, reach);
  REQUIRE(s.power.size() == 1849);
  for (int kx = -21; kx <= 21; ++kx)
    for (int ky = -21; ky <= 21; ++ky) {
      double re = 0, im = 0;
      for (std::uint64_t i = 0; i < p.size(); ++i) {
        const double phase = 2 * std::numbers::pi * (kx * p.at(i, 0) + ky * p.at(i, 1));
        re += std::cos(phase);
        im += std::sin(phase);
      }
      const auto index = static_cast<std::size_t>(kx + 21) * 43 + static_cast<std::size_t>(ky + 21);
      REQUIRE(s.power[index] == Approx((re * re + im * im) / 37).margin(1e-11));
    }
}

TEST_CASE("in fp32 the spectrum agrees to its precision", "[device]") {
  QualityKernels narrow(test::device(), false);
  PointSet p = drawn("sobol", 256, 2);  // 8 bits: exact in fp32
  const PowerSpectrum a = power_spectrum(quality_kernels(), {p}, 32),
                      b = power_spectrum(narrow, {p}, 32);
  for (std::size_t i = 0; i < a.power.size(); ++i)
    REQUIRE(b.power[i] == Approx(a.power[i]).margin(2e-3));
}

TEST_CASE("white noise has a flat spectrum, pair correlation 1 and the anisotropy of its averaging",
          "[statistical]") {
  // 64 sets of 256 points. P of one set is nearly exponential with mean 1, so the mean over 64 sets
  // and c independent frequencies has standard deviation 1 / sqrt(64 c). 32 rings at 6.5
  // deviations: false alarm below 32 * 8e-11 = 3e-9 for normal tails; c >= 4 averages 256
  // exponentials or more, whose tail at 6.5 deviations (gamma, 256) is below 1e-8: 4e-7 in all.
  const PowerSpectrum s = spectrum_of(white_noise(256, 64));
  REQUIRE(s.radial_mean.size() == 32);
  for (std::size_t r = 1; r <= 32; ++r) {
    double frequencies = 0;
    for (int kx = 0; kx <= 32; ++kx)
      for (int ky = kx == 0 ? 1 : -32; ky <= 32; ++ky)
        frequencies += std::lround(std::hypot(kx, ky)) == static_cast<long>(r);
    INFO("ring " << r << " of " << frequencies << " frequencies: " << s.radial_mean[r - 1]);
    CHECK(std::fabs(s.radial_mean[r - 1] - 1) <= 6.5 / std::sqrt(64 * frequencies));
  }
  // The variance of a mean of 64 exponentials is 1/64: -18.06 dB, with ring 32's 100 or so
  // frequencies to within a factor 2 (relative deviation of the variance about 0.14).
  REQUIRE(s.anisotropy_db.back());
  CHECK(*s.anisotropy_db.back() == Approx(-10 * std::log10(64.0)).margin(3));
  // Pairs in the ring of bin b: Poisson-like with mean 64 * 32640 * area; 6.5 deviations, bins of
  // at least 100 pairs: false alarm below 128 * 1e-9.
  const PairCorrelation g = pair_correlation(quality_kernels(), white_noise(256, 64));
  std::size_t checked = 0;
  for (std::size_t b = 0; b < g.value.size(); ++b) {
    const double pairs = 64 * 32640.0 * std::numbers::pi * g.bin_width * g.bin_width *
                         (2.0 * static_cast<double>(b) + 1);
    if (pairs < 100) continue;
    ++checked;
    INFO("bin " << b << ": " << g.value[b]);
    CHECK(std::fabs(g.value[b] - 1) <= 6.5 / std::sqrt(pairs) + 10 / pairs);
  }
  CHECK(checked > 100);
}

TEST_CASE("a regular grid is made of peaks: P = N at multiples of its side, 0 elsewhere",
          "[device]") {
  const std::uint32_t side = 16;
  const PowerSpectrum s = spectrum_of({grid(side)});
  const int reach = static_cast<int>(s.reach), width = 2 * reach + 1;
  REQUIRE(reach == 32);
  for (int kx = -reach; kx <= reach; ++kx)
    for (int ky = -reach; ky <= reach; ++ky) {
      const bool peak = kx % 16 == 0 && ky % 16 == 0;
      REQUIRE(s.power[static_cast<std::size_t>((kx + reach) * width + ky + reach)] ==
              Approx(peak ? 256 : 0).margin(1e-9));
    }
  CHECK(s.peak_frequency == 16);
  // Every point has its neighbours at 1/16, so pairs are missing below.
  const PairCorrelation g = pair_correlation(quality_kernels(), {grid(side)});
  for (std::size_t b = 0; b < g.value.size() && g.radius[b] + g.bin_width / 2 < 1.0 / 16; ++b)
    CHECK(g.value[b] == 0);
}

TEST_CASE("pair correlation counts every pair once, on the torus", "[device]") {
  const PointSet p = test::lcg_points(50, 2, 6);
  const PairCorrelation g = pair_correlation(quality_kernels(), {p});
  std::vector<double> count(g.value.size(), 0.0);
  for (std::uint64_t i = 0; i < 50; ++i)
    for (std::uint64_t k = 0; k < i; ++k) {
      const double gx = std::fabs(p.at(i, 0) - p.at(k, 0)), gy = std::fabs(p.at(i, 1) - p.at(k, 1));
      const double r = std::hypot(std::min(gx, 1 - gx), std::min(gy, 1 - gy));
      const auto bin = static_cast<std::size_t>(r / g.bin_width);
      if (bin < count.size()) count[bin] += 1;
    }
  CHECK(g.radius.back() <= 0.5);
  for (std::size_t b = 0; b < count.size(); ++b) {
    const double inner = g.bin_width * static_cast<double>(b), outer = inner + g.bin_width;
    const double expected = 1225 * std::numbers::pi * (outer * outer - inner * inner);
    CHECK(g.value[b] == Approx(count[b] / expected).margin(1e-9));
  }
}

TEST_CASE("sets that are one set shifted on the torus count as one", "[device]") {
  const PointSet p = test::lcg_points(64, 2, 9);
  PointSet shifted = p;
  for (double& x : shifted.x) x = std::fmod(x + 0.371, 1.0);
  CHECK(spectrum_of({p, shifted, p}).distinct_sets == 1);
  CHECK(spectrum_of({p, shifted, test::lcg_points(64, 2, 10)}).distinct_sets == 2);
  CHECK(spectrum_of(white_noise(64, 5)).distinct_sets == 5);
}

TEST_CASE("dart throwing has little power near zero frequency and no near pairs", "[statistical]") {
  // 16 sets, 6-definitions 18: measured there 0.07 to 0.10, white noise 1. White noise would pass
  // below 1e-6: the mean of 16 * c exponentials, c the frequencies below a quarter of the peak.
  const double distance = 0.7 * std::sqrt(2 / (std::sqrt(3.0) * 256));
  std::vector<PointSet> sets;
  for (std::uint64_t seed = 0; seed < 16; ++seed)
    sets.push_back(dart_throwing(256, distance, seed));
  const PowerSpectrum s = spectrum_of(sets);
  INFO("peak " << s.peak_frequency << ", low power " << s.low_frequency_power.value_or(-1));
  CHECK(s.peak_frequency > 12);
  CHECK(s.peak_frequency < 24);
  CHECK(s.low_frequency_power.value() < 0.2);
  const PairCorrelation g = pair_correlation(quality_kernels(), sets);
  for (std::size_t b = 0; b < g.value.size() && g.radius[b] + g.bin_width / 2 < distance; ++b)
    CHECK(g.value[b] == 0);
}

TEST_CASE("every sampler that declares blue-noise has low power below a quarter of the peak",
          "[statistical]") {
  // Mean over 0 < |k| < peak / 4 of 16 sets of 256 points, in units of white noise (6-definitions
  // 18). Seeds differ too, for samplers whose replicates are one set moved about.
  std::size_t declared = 0;
  for (const Sampler& sampler : test::catalog().samplers) {
    if (!test::has_property(sampler, "blue-noise") || !test::complete(sampler)) continue;
    ++declared;
    const std::uint64_t n = test::admitted_size(sampler, 2, 256);
    std::vector<PointSet> sets;
    for (std::uint32_t r = 0; r < (sampler.replicable ? 16 : 1); ++r)
      sets.push_back(
          {2, test::points(
                  {.sampler = sampler.name, .dim = 2, .count = n, .replicate = r, .seed = r + 1})});
    const PowerSpectrum s = spectrum_of(sets);
    INFO(sampler.name << ": peak " << s.peak_frequency << ", low power "
                      << s.low_frequency_power.value_or(-1));
    CHECK(s.low_frequency_power.value() < 0.2);
  }
  CHECK(declared > 0);
}
