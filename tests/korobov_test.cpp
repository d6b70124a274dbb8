// The error of an unshifted lattice on the Korobov kernels is P_alpha, a sum over its dual lattice:
// a check of lattices, their order and the integrands without statistics.
#include <catch2/catch.hpp>
#include <cmath>

#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr double kPi = 3.14159265358979323846;

// Sum over h = c mod n of gamma / |h|^alpha, where h = 0 counts 1: partial fractions of the
// cotangent (DLMF 4.22.3) and its derivatives.
double residue_sum(int alpha, double gamma, std::uint64_t c, std::uint64_t n) {
  const auto size = static_cast<double>(n);
  if (c == 0)
    return 1 + 2 * gamma * (alpha == 2 ? std::pow(kPi, 2) / 6 : std::pow(kPi, 4) / 90) /
                   std::pow(size, alpha);
  const double sine = std::sin(kPi * static_cast<double>(std::min(c, n - c)) / size);
  const double squared = std::pow(kPi / (size * sine), 2);
  return gamma * (alpha == 2 ? squared : squared * squared * (1 - 2 * sine * sine / 3));
}

// P_alpha of the lattice {k (1, z) / n}: the dual lattice is h_1 + z h_2 = 0 mod n.
double dual_lattice_sum(int alpha, double gamma_1, double gamma_2, std::uint64_t z,
                        std::uint64_t n) {
  double sum = residue_sum(alpha, gamma_1, 0, n) * residue_sum(alpha, gamma_2, 0, n) - 1;
  for (std::uint64_t c = 1; c < n; ++c)
    sum += residue_sum(alpha, gamma_1, (n - z * c % n) % n, n) * residue_sum(alpha, gamma_2, c, n);
  return sum;
}

// The second component of the generating vector whose first is 1.
std::uint64_t generator(const std::string& sampler, std::uint64_t n) {
  const auto x = test::points({.sampler = sampler, .dim = 2, .count = n});
  for (std::uint64_t i = 0; i < n; ++i)
    if (x[2 * i] * static_cast<double>(n) == 1)
      return static_cast<std::uint64_t>(x[2 * i + 1] * static_cast<double>(n));
  return 0;
}

}  // namespace

TEST_CASE(
    "the error of unshifted lattices on the Korobov kernels is P_alpha, their dual lattice's sum",
    "[device]") {
  for (const char* sampler : {"lattice", "korobov"}) {
    for (std::uint64_t n = 1 << 6; n <= 1 << 10; n *= 2) {
      const std::uint64_t z = generator(sampler, n);
      REQUIRE(z % 2 == 1);
      for (const int alpha : {2, 4}) {
        for (const int power : {0, 2}) {
          const std::string scene =
              "korobov-b" + std::to_string(alpha) + ":d=2,power=" + std::to_string(power);
          PreparedCell prepared(
              test::catalog(), test::device(), test::device(),
              make_plan(test::catalog(), test::cell(scene, sampler, n), test::device().facts()));
          const double error = *prepared.run_row(n).estimate.value - 1;
          const double expected = dual_lattice_sum(alpha, 1, power == 0 ? 1 : 0.25, z, n);
          INFO(sampler << " " << scene << " N = " << n << " z = " << z << ": " << error
                       << ", P = " << expected);
          CHECK(expected > 1e-11);
          CHECK(std::fabs(error - expected) <= 1e-14);
        }
      }
    }
  }
}
