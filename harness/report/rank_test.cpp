#include "report/rank_test.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace koksma {
namespace {

// Midranks of both samples in one order, doubled so that they are integers, and sum (t^3 - t) over
// groups of t ties.
struct Ranks {
  std::vector<std::size_t> doubled;  // sorted
  std::size_t doubled_sum_b = 0;
  double ties = 0;
};

Ranks rank(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<std::pair<double, bool>> all;
  for (const double x : a) all.emplace_back(x, false);
  for (const double x : b) all.emplace_back(x, true);
  std::sort(all.begin(), all.end());
  Ranks ranks;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end].first == all[i].first) ++end;
    // Ranks i + 1 ... end have the mean (i + 1 + end) / 2.
    for (std::size_t k = i; k < end; ++k) {
      ranks.doubled.push_back(i + 1 + end);
      if (all[k].second) ranks.doubled_sum_b += i + 1 + end;
    }
    const auto t = static_cast<double>(end - i);
    ranks.ties += t * t * t - t;
    i = end;
  }
  return ranks;
}

// P(sum >= observed) over all choices of n of the doubled midranks, all equally likely.
double exact_tail(const std::vector<std::size_t>& doubled, std::size_t n, std::size_t observed) {
  const std::size_t total = std::accumulate(doubled.begin(), doubled.end(), std::size_t{0});
  // ways[k][s]: choices of k of the ranks seen so far with sum s. At most C(40, 20) < 2^53.
  std::vector<std::vector<double>> ways(n + 1, std::vector<double>(total + 1, 0.0));
  ways[0][0] = 1;
  std::size_t seen = 0, reached = 0;
  for (const std::size_t r : doubled) {
    ++seen;
    reached += r;
    for (std::size_t k = std::min(n, seen); k > 0; --k)
      for (std::size_t s = reached; s >= r; --s) ways[k][s] += ways[k - 1][s - r];
  }
  double all = 0, tail = 0;
  for (std::size_t s = 0; s <= total; ++s) {
    all += ways[n][s];
    if (s >= observed) tail += ways[n][s];
  }
  return tail / all;
}

// Variance of a rank sum of n of N ranks with ties (Lehmann 1975, equation 1.35).
double rank_sum_variance(std::size_t m, std::size_t n, double ties) {
  const auto product = static_cast<double>(m) * static_cast<double>(n);
  const auto all = static_cast<double>(m + n);
  return product / 12 * (all + 1 - (all > 1 ? ties / (all * (all - 1)) : 0));
}

}  // namespace

double normal_tail(double z) { return std::erfc(z / std::sqrt(2.0)) / 2; }

RankTest mann_whitney(const std::vector<double>& a, const std::vector<double>& b) {
  RankTest test;
  if (a.empty() || b.empty()) return test;
  const Ranks ranks = rank(a, b);
  const auto m = static_cast<double>(a.size()), n = static_cast<double>(b.size());
  test.u = static_cast<double>(ranks.doubled_sum_b) / 2 - n * (n + 1) / 2;
  if (a.size() + b.size() <= kMostExactRanks) {
    test.exact = true;
    test.p = exact_tail(ranks.doubled, b.size(), ranks.doubled_sum_b);
    return test;
  }
  const double variance = rank_sum_variance(a.size(), b.size(), ranks.ties);
  if (variance > 0) test.p = normal_tail((test.u - m * n / 2 - 0.5) / std::sqrt(variance));
  return test;
}

double shift_estimate(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> differences;
  for (const double x : a)
    for (const double y : b) differences.push_back(y - x);
  if (differences.empty()) return 0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  if (differences.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(differences.begin(), middle)) / 2;
}

double van_elteren(const std::vector<Stratum>& strata) {
  double excess = 0, variance = 0;
  for (const Stratum& s : strata) {
    if (s.a.empty() || s.b.empty()) continue;
    const Ranks ranks = rank(s.a, s.b);
    const auto m = static_cast<double>(s.a.size()), n = static_cast<double>(s.b.size());
    const double weight = 1 / (m + n + 1);
    excess += weight * (static_cast<double>(ranks.doubled_sum_b) / 2 - n * (m + n + 1) / 2);
    variance += weight * weight * rank_sum_variance(s.a.size(), s.b.size(), ranks.ties);
  }
  return variance > 0 ? normal_tail(excess / std::sqrt(variance)) : 1;
}

}  // namespace koksma
