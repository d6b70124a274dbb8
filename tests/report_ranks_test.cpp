// Rank tests against enumerated tables and by simulation.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "report/rank_test.hpp"

using namespace koksma;

namespace {

// P(U >= u) by going through every way to deal the values out.
double enumerated_tail(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all = a;
  all.insert(all.end(), b.begin(), b.end());
  const auto u_of = [&](const std::vector<bool>& is_b) {
    double u = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = 0; j < all.size(); ++j)
        if (!is_b[i] && is_b[j]) u += all[j] > all[i] ? 1 : all[j] == all[i] ? 0.5 : 0;
    return u;
  };
  std::vector<bool> is_b(all.size(), false);
  std::fill(is_b.begin() + static_cast<std::ptrdiff_t>(a.size()), is_b.end(), true);
  const double observed = u_of(is_b);
  double ways = 0, at_least = 0;
  std::sort(is_b.begin(), is_b.end());
  do {
    ++ways;
    at_least += u_of(is_b) >= observed ? 1 : 0;
  } while (std::next_permutation(is_b.begin(), is_b.end()));
  return at_least / ways;
}

std::vector<double> normals(std::mt19937_64& random, std::size_t count, double mean) {
  std::normal_distribution<double> normal(mean, 1);
  std::vector<double> values(count);
  for (double& v : values) v = normal(random);
  return values;
}

}  // namespace

TEST_CASE("the exact distribution of U is that of Mann and Whitney's table", "[unit]") {
  // Mann, Whitney (1947), table I: P(U <= u), here by symmetry P(U >= mn - u).
  struct Entry {
    std::size_t m, n;
    std::size_t u;
    double p;
  };
  // The counts are 1, 1, 2, 3, ... of C(m + n, m), as partitions of u into at most m parts of at
  // most n.
  for (const Entry& e :
       {Entry{3, 3, 0, 1.0 / 20}, Entry{3, 3, 1, 2.0 / 20}, Entry{3, 3, 2, 4.0 / 20},
        Entry{3, 3, 3, 7.0 / 20}, Entry{4, 4, 0, 1.0 / 70}, Entry{4, 4, 3, 7.0 / 70},
        Entry{4, 4, 5, 17.0 / 70}, Entry{5, 5, 4, 12.0 / 252}, Entry{8, 8, 0, 1.0 / 12870},
        Entry{8, 8, 1, 2.0 / 12870}}) {
    // b above a but for u pairs: with b = n + 1 ... and one or more a moved up.
    std::vector<double> a(e.m), b(e.n);
    std::iota(b.begin(), b.end(), 1000.0);
    std::iota(a.begin(), a.end(), 0.0);
    std::size_t left = e.u;
    for (std::size_t i = a.size(); i-- > 0 && left > 0;) {
      const std::size_t above = std::min(left, e.n);
      a[i] = 999.5 + static_cast<double>(above) + 1e-3 * static_cast<double>(i);
      left -= above;
    }
    const RankTest test = mann_whitney(a, b);
    INFO(e.m << " " << e.n << " " << e.u);
    CHECK(test.exact);
    CHECK(test.u == static_cast<double>(e.m * e.n - e.u));
    CHECK(test.p == Approx(e.p).epsilon(1e-14));
  }
}

TEST_CASE("with ties the exact distribution is that of all ways to deal the values out", "[unit]") {
  std::mt19937_64 random(7);
  for (int repeat = 0; repeat < 40; ++repeat) {
    std::vector<double> a(3 + random() % 3), b(3 + random() % 3);
    for (double& v : a) v = static_cast<double>(random() % 4);
    for (double& v : b) v = static_cast<double>(random() % 4);
    CHECK(mann_whitney(a, b).p == Approx(enumerated_tail(a, b)).epsilon(1e-12));
  }
  CHECK(mann_whitney({1, 1, 1}, {1, 1}).p == 1);
  CHECK(mann_whitney({}, {1.0}).p == 1);
}

TEST_CASE("larger samples take the normal approximation with continuity correction", "[unit]") {
  std::mt19937_64 random(11);
  for (const double shift : {0.0, 0.4, 0.8}) {
    const auto a = normals(random, 21, 0), b = normals(random, 20, shift);
    const RankTest test = mann_whitney(a, b);
    REQUIRE_FALSE(test.exact);
    const double z = (test.u - 210 - 0.5) / std::sqrt(420.0 * 42 / 12);
    CHECK(test.p == Approx(normal_tail(z)).epsilon(1e-12));
    // Without one value the sample is small enough for the exact tail, which differs little.
    const RankTest exact = mann_whitney({a.begin(), a.end() - 1}, b);
    REQUIRE(exact.exact);
    CHECK(std::fabs(test.p - exact.p) < 0.05);
  }
  const std::vector<double> same(30, 1.0);
  CHECK(mann_whitney(same, same).p == 1);
}

TEST_CASE("the shift is the median of all differences", "[unit]") {
  CHECK(shift_estimate({1, 2, 3}, {11, 12, 13}) == 10);
  CHECK(shift_estimate({0, 1}, {10, 100}) == Approx((10 + 99) / 2.0));
  CHECK(shift_estimate({}, {1}) == 0);
}

TEST_CASE("van Elteren's test of one stratum is the uncorrected normal rank test", "[unit]") {
  std::mt19937_64 random(3);
  const auto a = normals(random, 9, 0), b = normals(random, 7, 1);
  const double u = mann_whitney(a, b).u;
  const double z = (u - 63.0 / 2) / std::sqrt(63.0 * 17 / 12);
  CHECK(van_elteren({{a, b}}) == Approx(normal_tail(z)).epsilon(1e-12));
  CHECK(van_elteren({}) == 1);
  CHECK(van_elteren({{{1, 1}, {1, 1}}}) == 1);
  // Strata on other scales change nothing, and weigh 1 / (m + n + 1): twice the same is sqrt 2 z.
  auto far_a = a, far_b = b;
  for (double& v : far_a) v += 1000;
  for (double& v : far_b) v += 1000;
  CHECK(van_elteren({{a, b}, {far_a, far_b}}) == Approx(normal_tail(std::sqrt(2.0) * z)));
}

TEST_CASE("under no change the tests reject at their level and no more", "[statistical]") {
  // 20,000 repetitions at level 0.05: the limit is five standard deviations (3e-7 one-sided; the
  // exact test is discrete and rejects less).
  std::mt19937_64 random(5);
  int rows = 0, strata = 0;
  constexpr int kRepeats = 20000;
  for (int i = 0; i < kRepeats; ++i) {
    rows += mann_whitney(normals(random, 6, 0), normals(random, 6, 0)).p <= 0.05;
    std::vector<Stratum> three;
    for (const double place : {0.0, 5.0, 50.0})
      three.push_back({normals(random, 5, place), normals(random, 5, place)});
    strata += van_elteren(three) <= 0.05;
  }
  const double limit = 0.05 + 5 * std::sqrt(0.05 * 0.95 / kRepeats);
  CHECK(rows / double{kRepeats} < limit);
  CHECK(rows / double{kRepeats} > 0.03);
  CHECK(strata / double{kRepeats} < limit);
  CHECK(strata / double{kRepeats} > 0.04);
}
