// What a cell whose f solves a differential equation reports beside the usual: two errors, that of
// sampling and that of all, and what its integrator does (page 5, section 1.7).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace koksma {

struct OdeReport {
  // RMSE about the mean of the numerical solution, or without one about that of the replicates.
  std::optional<double> sampling_rmse;
  std::string_view sampling_against;  // "discrete mean" | "replicates"; "": there is none
  std::optional<double> total_rmse;   // about the true integral
  // E f_h − E f: that of the means, or the mean error of the replicates with its standard error.
  std::optional<double> integrator_bias, bias_error;
  std::string_view bias_from;  // "discrete mean" | "replicates"; "": there is none
  std::optional<double> stiffness, max_abs_r;
  std::optional<std::uint64_t> blow_ups;  // samples above 10 times the bound; none: not counted

  // Of the integrator, in units of the true integral; none where that is 0 or not known.
  std::optional<double> relative_bias(const std::optional<double>& mean) const;
};

// max |R(z)| for z in [−stiffness, 0], R = numerator/denominator with coefficients by ascending
// powers, no pole there; stiffness > 0. Exact to the width of 2^12 steps that are equal in z and in
// log |z|. None for an empty fraction or where R is not finite.
std::optional<double> largest_growth(std::span<const double> numerator,
                                     std::span<const double> denominator, double stiffness);

// What replicates of one N say. `estimates`: Q_r, all finite, else nothing is said.
OdeReport report_ode(std::span<const double> estimates, const std::optional<double>& mean,
                     const std::optional<double>& discrete_mean);

}  // namespace koksma
