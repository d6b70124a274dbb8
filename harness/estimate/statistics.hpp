// Statistics of R replicate estimates, and the sample variance from a kernel's sums.
//
// What cannot be said is absent (std::nullopt), never a NaN: an error without an exact value, a
// deviation of one replicate, anything at all when a replicate is not finite. Sums are exact, so no
// order of replicates matters to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "estimate/exact_sum.hpp"
#include "estimate/interval.hpp"

namespace koksma {

// Errors are e_r = Q_r − I of single N-point estimates (page 6, definition 13).
struct ErrorStatistics {
  std::size_t replicates = 0;      // R, all that were given
  std::size_t nonfinite = 0;       // of them NaN or infinite; above 0 nothing below is set
  std::optional<double> mean;      // of the estimates Q_r
  std::optional<double> sd;        // of the estimates, ÷ (R − 1); R ≥ 2
  std::optional<double> kurtosis;  // of the estimates, m4/m2² (normal: 3); R ≥ 4 and sd > 0
  std::optional<double> bias;      // mean e_r; this and all below need the exact value
  std::optional<double> rmse;      // √(Σ e_r² / R)
  std::optional<double> rmse_low;  // 95 % interval of the RMSE; R ≥ 2 and rmse > 0
  std::optional<double> rmse_high;
  std::string_view rmse_interval_method;  // "chi-squared", "bootstrap", empty without an interval
  std::optional<double> median_abs;       // median |e_r|
  std::optional<double> rho;              // rmse / median_abs (normal: 1.483); median_abs > 0
  bool heavy_tailed = false;              // rho > 3, or rmse > 0 with median_abs = 0; R ≥ 16
};

// Ratio of RMSE to median |e| above which errors count as heavy-tailed (page 5, section 3).
inline constexpr double kHeavyTailRatio = 3;

// Replicates below which the ratio says nothing: of normal errors 5 rows in 100 exceed it at R = 8.
inline constexpr std::size_t kFewestForTails = 16;

// R ≥ 0 estimates in any unit; `exact` in the same unit, ignored when it is not finite.
ErrorStatistics summarise_errors(std::span<const double> estimates, std::optional<double> exact);

// √(mean of squares), without overflow or underflow of the squares; 0 for an empty span.
double root_mean_square(std::span<const double> values);

// Median of |values|, the mean of the middle two for an even count; 0 for an empty span.
double median_abs(std::span<const double> values);

// Factors [√(R/χ²_{R,.975}), √(R/χ²_{R,.025})] that turn the RMSE of R ≥ 1 normal errors of mean 0
// into its 95 % interval, for R·MSE/σ² ~ χ²_R.
Interval rmse_factors(std::size_t replicates);

// Two-sided 1 % test of normal kurtosis: F. J. Anscombe, W. J. Glynn, Distribution of the kurtosis
// statistic b2 for normal samples, Biometrika 70 (1983). `kurtosis` is m4/m2² of `size` values;
// below 8 values it always holds.
bool kurtosis_is_normal(double kurtosis, std::size_t size);

// Unbiased sample variance (÷ (N − 1)) of N values from Σ y and Σ (y − y0)²: (S2 − (S1 −
// N·y0)²/N)/(N − 1), with S1 − N·y0 exact (T. F. Chan, G. H. Golub, R. J. LeVeque, Am. Stat. 37
// (1983), shifted data). Never negative; exactly 0 where the difference is below the rounding of
// the squares, so for all constants. `unit_roundoff` is that of the squares. None for N < 2 or
// where a sum is not finite.
std::optional<double> sample_variance(std::uint64_t n, const ExactSum& sum_y,
                                      const ExactSum& sum_sq_about_y0, double y0,
                                      double unit_roundoff = 0x1p-53);

}  // namespace koksma
