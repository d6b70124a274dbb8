// Everything that `koksma quality` measures of one point set, or of several randomizations of it.
// Each number comes with how it is known, and what was not computed says why.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quality/spectrum.hpp"

namespace koksma {

// One number about the first set.
struct Measure {
  std::string name;  // key of the JSON
  std::string title;
  std::optional<double> value;
  std::string how;              // "exact" (but for rounding), "lower-bound", "upper-bound"
  std::optional<bool> squared;  // for what goes by either convention
  std::string method;           // formula and citation
  std::string reason;           // why there is no value; empty where there is one
};

struct Quality {
  std::vector<Measure> measures;
  std::uint32_t sets = 1;  // that the following are averaged over
  std::optional<PairCorrelation> pair_correlation;
  std::optional<PowerSpectrum> power_spectrum;
  std::string pair_correlation_reason, power_spectrum_reason;

  const Measure& measure(const std::string& name) const;  // std::out_of_range: a bug of ours
};

// What one measure may cost, in units of its inner loop; tests lower them. The defaults keep each
// below about a minute on two cores.
struct QualityLimits {
  double pair_terms = 0x1p37;  // N^2 d
  double star_2d_n = 0x1p17, star_3d_n = 0x1p12;
  double star_1d_n = 0x1p24;
  double search_visits = 0x1p34;    // points times coordinates
  double cover_visits = 0x1p33;     // points times coordinates times brackets
  double cover_brackets = 0x1p20;   // the host makes them
  double spectrum_terms = 0x1p36;   // points times frequencies times sets
  double histogram_pairs = 0x1p35;  // pairs times sets
};

// sets: independent randomizations of one size, at least one, not empty. All but the averages are
// of the first.
Quality measure_quality(QualityKernels& kernels, const std::vector<PointSet>& sets,
                        const QualityLimits& limits = {});

}  // namespace koksma
