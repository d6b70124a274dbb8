// Does plain Monte Carlo have the variance it must have?
//
// With independent samples of known variance σ², T = R·MSE·N/σ² follows χ²_R as far as the error of
// one replicate is normal. A slope of −1/2 cannot see correlated or duplicated streams; this test
// does (page 5, section 3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace koksma {

struct McTest {
  bool applicable = false;
  std::string reason;               // why not applicable, else empty
  std::size_t replicates = 0;       // R, the degrees of freedom
  std::optional<double> statistic;  // T
  std::optional<double> p_value;    // two-sided: 2·min(P(χ²_R ≤ T), P(χ²_R ≥ T))
};

// `errors` are Q_r − I of R replicates of N = `samples` values each, `variance` the exact σ² of one
// value. The normal approximation is believed where excess kurtosis / N < 0.1; an unknown kurtosis
// is not held against the test.
McTest test_mc_variance(std::span<const double> errors, std::uint64_t samples, double variance,
                        std::optional<double> excess_kurtosis);

// Overall false-alarm probability of all rows of one run.
inline constexpr double kMcFalseAlarm = 1e-6;

// Whether the row contradicts σ² at level kMcFalseAlarm / rows (Bonferroni), rows ≥ 1; never when
// not applicable.
bool contradicts_variance(const McTest& test, std::size_t rows);

}  // namespace koksma
