// Spectral and spatial statistics of planar sets, averaged over independent sets of one size.
#pragma once

#include <optional>

#include "quality/kernels.hpp"

namespace koksma {

// g(r) on the torus: pairs at distances in [r_b, r_b+1) over those expected of independent uniform
// points, N (N - 1) / 2 times the area of the ring, so that white noise has mean 1 in every bin.
struct PairCorrelation {
  std::vector<double> radius;  // centre of the bin
  std::vector<double> value;
  double bin_width = 0;
};
PairCorrelation pair_correlation(QualityKernels& kernels, const std::vector<PointSet>& sets);

// P(k) = |sum exp(-2 pi i k.x)|^2 / N, 1 in the mean for white noise (k != 0).
struct PowerSpectrum {
  std::uint32_t reach = 0;  // frequencies -reach ... reach
  // Sets with spectra of their own: 1 where replicates are the same set shifted on the torus, as
  // averaging them averages nothing.
  std::uint32_t distinct_sets = 0;
  std::vector<double> power;  // [kx + reach][ky + reach], mean over the sets; P(0) = N
  // Rings of width 1 about integer frequencies 1 ... reach (Lagae & Dutre 2008): the mean power,
  // and the variance of the power within the ring over the squared mean, in dB (Ulichney 1987);
  // both over the independent half of the frequencies. White noise has -10 log10(distinct_sets) dB.
  std::vector<double> radial_mean;
  std::vector<std::optional<double>> anisotropy_db;
  double peak_frequency = 0;  // the ring with the greatest mean
  // Mean power over 0 < |k| < peak / 4, in units of white noise; empty where there is no frequency.
  std::optional<double> low_frequency_power;
};
// reach: about twice the mean frequency sqrt(N), so that the first peaks are in.
std::uint32_t spectrum_reach(std::uint64_t n);
PowerSpectrum power_spectrum(QualityKernels& kernels, const std::vector<PointSet>& sets,
                             std::uint32_t reach);

}  // namespace koksma
