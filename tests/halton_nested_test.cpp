// Nested scrambling of radical inverses is uniform: in tabulated digits and in those that the
// kernel hashes.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "tests/halton_support.hpp"

using namespace koksma;
using namespace koksma::test;

TEST_CASE(
    "nested scrambling of base 2, 3, 5 and 7: 12 N^3 Var = 1 on f = x at N = b^k, and kurtosis as "
    "theory says",
    "[statistical]") {
  // The mean of N = b^k points is one of N independent uniforms on strata of length 1/N (Owen
  // 1995): variance 1/(12 N^3), kurtosis 3 - 1.2/N. R = 10^4; chi-squared at 1e-7 each, kurtosis
  // within 6 standard deviations sqrt(24/R): false alarm below 1e-6.
  const std::uint32_t count = 10000, dim = 4;
  const Sampler s = test::catalog().sampler("halton-owen", "test");
  const auto sets = replicates(s, dim, 81, count);
  for (const auto& [d, n] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {0, 64}, {1, 81}, {1, 9}, {2, 25}, {3, 49}}) {
    double m2 = 0, m4 = 0;
    for (const auto& x : sets) {
      double e = 0;
      for (std::uint32_t i = 0; i < n; ++i) e += (x[i * dim + d] - 0.5) / n;
      m2 += e * e / count;
      m4 += e * e * e * e / count;
    }
    const double ratio = 12 * std::pow(n, 3) * m2, kurtosis = m4 / (m2 * m2);
    INFO("dimension " << d << " N " << n << ": 12 N^3 Var = " << ratio << ", kurtosis "
                      << kurtosis);
    CHECK(two_sided(ratio * count, count) > 1e-7);
    CHECK(std::fabs(kurtosis - (3 - 1.2 / n)) < 6 * std::sqrt(24.0 / count));
  }
}

TEST_CASE(
    "nested scrambling below the tabulated digits: the points of every node are nested-scrambled "
    "anew, 12 N^3 Var = 1 with theory's kurtosis inside a node, in bases 3 ... 37",
    "[statistical]") {
  // Index r + B c: the node of the first digits r, at its points c. Their places inside the node's
  // interval are a scrambled sequence of their own; nodes are independent. 20 tests at 1e-8 and as
  // many kurtoses within 6 standard deviations: false alarm below 1e-6.
  const Sampler s = test::catalog().sampler("halton-owen", "test");
  for (const auto& [d, size, children, count] :
       std::vector<std::array<std::uint32_t, 4>>{{1, 6561, 9, 2},
                                                 {2, 3125, 25, 4},
                                                 {3, 2401, 49, 4},
                                                 {4, 1331, 121, 4},
                                                 {7, 6859, 19, 2},
                                                 {8, 529, 23, 12},
                                                 {8, 529, 529, 4},
                                                 {11, 37, 1369, 40}}) {
    const auto sets = replicates(s, kDim, std::uint64_t{size} * children, count);
    double m2 = 0, m4 = 0, samples = 0;
    for (const auto& x : sets) {
      for (std::uint32_t r = 0; r < size; ++r, ++samples) {
        double e = 0;
        for (std::uint64_t c = 0; c < children; ++c) {
          const double place = x[(r + size * c) * kDim + d] * size;
          e += (place - std::floor(place) - 0.5) / children;
        }
        m2 += e * e;
        m4 += e * e * e * e;
      }
    }
    const double ratio = 12 * std::pow(children, 3) * m2 / samples,
                 kurtosis = m4 * samples / (m2 * m2);
    INFO("dimension " << d << " N " << children << " in " << samples
                      << " nodes: 12 N^3 Var = " << ratio << ", kurtosis " << kurtosis);
    CHECK(two_sided(ratio * samples, samples) > 1e-8);
    CHECK(std::fabs(kurtosis - (3 - 1.2 / children)) < 6 * std::sqrt(24.0 / samples));
  }
}

TEST_CASE(
    "nested scrambling: the permutation of a node is uniform, over all orders in bases 3 and 5 and "
    "over pairs of digits in larger ones, tabulated or hashed",
    "[statistical]") {
  // Digit a of points r + a B, over the nodes r of all replicates, B the size of the table; and the
  // digit after it, below digit 1. Chi-squared at 1e-9 each, 18 tests.
  const Sampler s = test::catalog().sampler("halton-owen", "test");
  for (const auto& [d, size, tuple, count] :
       std::vector<std::array<std::uint32_t, 4>>{{1, 6561, 3, 2},
                                                 {2, 3125, 5, 2},
                                                 {3, 2401, 3, 4},
                                                 {4, 1331, 2, 6},
                                                 {5, 2197, 2, 4},
                                                 {6, 4913, 2, 2},
                                                 {7, 6859, 2, 2},
                                                 {8, 529, 2, 16},
                                                 {11, 37, 2, 400}}) {
    const std::uint64_t base = base_of(s, d);
    const std::uint64_t from = base > 7 ? 1 : 0;  // two digits other than 0: their tau differ
    for (const std::uint64_t above : {std::uint64_t{0}, size * std::uint64_t{1}}) {
      const std::uint64_t step = above == 0 ? size : size * base;
      std::map<std::vector<std::uint64_t>, std::uint32_t> orders;
      const Plan plan = make_points_plan(test::catalog(), s.name, kDim, Precision::fp64,
                                         step * (from + tuple), count, 1, test::device().facts());
      PointsDump dump(test::device(), plan);
      for (std::uint32_t r = 0; r < count; ++r) {
        std::vector<std::vector<double>> x;
        for (std::uint32_t a = 0; a < tuple; ++a)
          x.push_back(dump.read(above + (from + a) * step, size, step * (from + tuple), r, 8));
        for (std::uint32_t i = 0; i < size; ++i) {
          std::vector<std::uint64_t> order;
          for (std::uint32_t a = 0; a < tuple; ++a)
            order.push_back(interval_of(x[a][i * kDim + d], step * base) % base);
          ++orders[order];
        }
      }
      std::size_t cells = 1;
      for (std::uint64_t a = 0; a < tuple; ++a) cells *= base - a;
      INFO("base " << base << ", " << tuple << " digits, below index " << above);
      check_uniform(orders, cells);
    }
  }
}
