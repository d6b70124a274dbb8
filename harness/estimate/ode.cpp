#include "estimate/ode.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimate/statistics.hpp"

namespace koksma {

namespace {

double polynomial(std::span<const double> coefficients, double z) {
  double value = 0;
  for (std::size_t k = coefficients.size(); k-- > 0;) value = value * z + coefficients[k];
  return value;
}

}  // namespace

std::optional<double> largest_growth(std::span<const double> numerator,
                                     std::span<const double> denominator, double stiffness) {
  constexpr int kSteps = 1 << 12;
  constexpr double kSmallest = 1e-3;  // |z| of the least step: R is about 1 + z below
  if (numerator.empty() || denominator.empty() || !(stiffness > 0)) return std::nullopt;
  const auto growth = [&](double z) {
    return std::fabs(polynomial(numerator, z) / polynomial(denominator, z));
  };
  const double least = kSmallest / std::max(stiffness, 1.0);
  double largest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    for (const double z : {-stiffness * part, -stiffness * std::pow(least, part)}) {
      const double r = growth(z);
      if (!std::isfinite(r)) return std::nullopt;
      largest = std::max(largest, r);
    }
  }
  return largest;
}

std::optional<double> OdeReport::relative_bias(const std::optional<double>& mean) const {
  if (!integrator_bias || !mean || *mean == 0) return std::nullopt;
  return *integrator_bias / *mean;
}

OdeReport report_ode(std::span<const double> estimates, const std::optional<double>& mean,
                     const std::optional<double>& discrete_mean) {
  OdeReport report;
  if (discrete_mean && mean) {
    report.integrator_bias = *discrete_mean - *mean;
    report.bias_from = "discrete mean";
  }
  const ErrorStatistics total = summarise_errors(estimates, mean);
  if (estimates.empty() || total.nonfinite > 0) return report;
  report.total_rmse = total.rmse;
  const double size = static_cast<double>(estimates.size());
  if (discrete_mean) {
    report.sampling_rmse = summarise_errors(estimates, discrete_mean).rmse;
    report.sampling_against = "discrete mean";
  } else if (total.sd) {
    report.sampling_rmse = total.sd;
    report.sampling_against = "replicates";
  }
  if (!report.integrator_bias && total.bias && total.sd) {
    report.integrator_bias = total.bias;
    report.bias_error = *total.sd / std::sqrt(size);
    report.bias_from = "replicates";
  }
  return report;
}

}  // namespace koksma
