// Rank tests of "the second sample is larger than the first", which ask nothing of the distribution
// of times but that launches are exchangeable where nothing has changed.
//   Mann, Whitney (1947), On a test of whether one of two random variables is stochastically larger
//   than the other. Lehmann (1975), Nonparametrics: sections 1.2 (rank sums), 1.4 (ties: the
//   distribution given the midranks), 2.5 (shift), 3.3 (combining blocks). Hodges, Lehmann (1963),
//   Estimates of location based on rank tests. van Elteren (1960), On the combination of
//   independent two sample tests of Wilcoxon.
#pragma once

#include <vector>

namespace koksma {

// Larger m + n take the normal approximation with tie correction.
inline constexpr std::size_t kMostExactRanks = 40;

struct RankTest {
  double u = 0;  // pairs (a, b) with b > a, ties count one half
  double p = 1;  // P(U >= u) where both samples come from one distribution
  bool exact =
      false;  // the distribution given the midranks; else normal with continuity correction
};

// The Mann-Whitney test, one-sided; empty samples give p = 1.
RankTest mann_whitney(const std::vector<double>& a, const std::vector<double>& b);

// The Hodges-Lehmann estimate of how much larger b is: the median of all b_j - a_i; 0 of empty
// samples.
double shift_estimate(const std::vector<double>& a, const std::vector<double>& b);

struct Stratum {
  std::vector<double> a, b;
};

// van Elteren's combination: rank sums of b over the strata, weighted by 1 / (m + n + 1), against
// its normal distribution, one-sided. 1 where there is nothing to rank.
double van_elteren(const std::vector<Stratum>& strata);

// P(Z >= z) of a standard normal variable.
double normal_tail(double z);

}  // namespace koksma
