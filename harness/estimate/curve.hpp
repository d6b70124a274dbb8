// The used rows of a convergence fit, laid out for resampling, and the slope of one resample.
//
// A resample is a vector of counts: how often each replicate occurs. All ones is the sample itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimate/convergence.hpp"

namespace koksma {

struct Curve {
  std::size_t rows = 0;              // M
  std::size_t replicates = 0;        // R
  std::vector<double> log2_samples;  // M
  std::vector<double> exponents;  // M: errors are stored ÷ 2^exponent, which keeps e⁴ in range
  std::vector<double> squares;    // R × M: scaled e²
  std::vector<std::uint32_t> ranked;  // M × R: replicates by ascending |e|
  std::vector<double> ranked_abs;     // M × R: their scaled |e|
};

// Rows must be finite, not all zero, and equal in their number of replicates.
Curve make_curve(const std::vector<const ConvergenceRow*>& rows);

struct Line {
  double slope = 0;
  double intercept = 0;  // log2 RMSE at N = 1
};

// Weighted least-squares line of y = log2 RMSE with weights 1/Var(y), Var(y) = (κ₄ − 1)/(4 R ln²
// 2), κ₄ = E e⁴/(E e²)² (delta method on the mean of e²; page 5, section 3). For R = 1 ordinary
// least squares. None if an RMSE is 0.
std::optional<Line> rmse_line(const Curve& curve, std::span<const std::uint32_t> counts);
// Its slope alone.
std::optional<double> rmse_slope(const Curve& curve, std::span<const std::uint32_t> counts);

// Ordinary least-squares slope of log2 median |e|. None if a median is 0.
std::optional<double> median_slope(const Curve& curve, std::span<const std::uint32_t> counts);

}  // namespace koksma
