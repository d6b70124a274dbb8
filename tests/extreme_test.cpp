// What is exact on extreme integrands: aliasing of nets and lattices, coverage of the first 2^m
// points, sums that leave the range of numbers though their mean does not, variances beside large
// means, forms that fail where they must.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cfloat>
#include <cmath>
#include <span>

#include "estimate/exact_sum.hpp"
#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;

namespace {

PreparedCell prepare(const std::string& scene, const std::string& sampler, Precision precision,
                     std::uint32_t replicates = 1, const std::string& estimator = "") {
  Cell c = cell(scene, sampler, 1 << 14, replicates, estimator);  // the largest N of a row
  c.precision = precision;
  return {test::catalog(), test::device(), test::device(),
          make_plan(test::catalog(), c, test::device().facts())};
}

bool all_are(const std::vector<double>& values, double value) {
  return std::all_of(values.begin(), values.end(), [=](double v) { return v == value; });
}

// The exact sum of one unscrambled net, and its mean.
struct NetSum {
  double sum, mean;
};

NetSum sum_of_net(const std::string& scene, Precision precision, std::uint64_t n) {
  Cell c = cell(scene, "sobol", n);
  c.precision = precision;
  c.sum = "naive";
  ExactSum sum;
  sum.add(test::partial_sums(c, {16, 1, {}, {}}));
  return {sum.rounded(), sum.rounded_quotient(n)};
}

}  // namespace

TEST_CASE("2^m points of a net see one sign of the Rademacher function r_m, 2^(m+1) both alike",
          "[device]") {
  PreparedCell plain = prepare("walsh-alias:m=8", "sobol", Precision::fp64);
  for (const std::uint64_t n : {1U, 2U, 32U, 256U}) CHECK(all_are(plain.run_row(n).estimates, 1));
  for (const std::uint64_t n : {512U, 1024U, 4096U}) CHECK(all_are(plain.run_row(n).estimates, 0));
  PreparedCell scrambled = prepare("walsh-alias:m=8", "sobol-owen", Precision::fp32, 16);
  CHECK_FALSE(all_are(scrambled.run_row(256).estimates, 0));
  for (const std::uint64_t n : {512U, 1024U}) CHECK(all_are(scrambled.run_row(n).estimates, 0));
}

TEST_CASE("a checkerboard of 2^j cells a side is exactly 0 on scrambled (0,m,2)-nets from 4^j on",
          "[device]") {
  for (const auto& [cells, needed] : {std::pair{4U, 16U}, {8U, 64U}, {32U, 1024U}}) {
    PreparedCell prepared =
        prepare(fmt::format("checkerboard:d=2,k={}", cells), "sobol-owen", Precision::fp32, 16);
    INFO("k = " << cells);
    CHECK_FALSE(all_are(prepared.run_row(needed / 2).estimates, 0));
    CHECK(all_are(prepared.run_row(needed).estimates, 0));
    CHECK(all_are(prepared.run_row(std::uint64_t{2} * needed).estimates, 0));
  }
}

TEST_CASE("the first 2^m unscrambled points miss the mean of x by exactly -2^-(m+1)", "[device]") {
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    PreparedCell prepared = prepare("sum-x:d=1", "sobol", precision);
    for (int m = 0; m <= 14; ++m)
      CHECK(prepared.run_row(std::uint64_t{1} << m).estimates[0] == 0.5 - std::ldexp(1.0, -m - 1));
  }
}

TEST_CASE("the first 2^m shifted, centred points miss it by that less their least coordinate",
          "[device]") {
  // A digital shift permutes the top m bits; the others are those of the shift for all points, and
  // their centre adds 2^-(b+1): 2^-24 in fp32, so the least is an odd multiple of it.
  PreparedCell prepared = prepare("sum-x:d=1", "sobol-shift", Precision::fp32, 4);
  for (const int m : {4, 8, 14}) {
    const std::uint64_t n = std::uint64_t{1} << m;
    const Row row = prepared.run_row(n);
    for (std::uint32_t r = 0; r < 4; ++r) {
      const auto x = test::points(
          {.sampler = "sobol-shift", .precision = Precision::fp32, .count = n, .replicate = r});
      const double least = *std::min_element(x.begin(), x.end());
      INFO("m = " << m << ", replicate " << r);
      CHECK(least < std::ldexp(1.0, -m));
      CHECK(std::fmod(std::ldexp(least, 24), 2.0) == 1);
      CHECK(row.estimates[r] == 0.5 - std::ldexp(1.0, -m - 1) + least);
    }
  }
}

TEST_CASE("up to 2^m points a lattice sees a constant in cos(2 pi 2^m x), beyond exactly 0",
          "[device]") {
  PreparedCell plain = prepare("lattice-alias:m=8", "lattice", Precision::fp64);
  for (const std::uint64_t n : {16U, 64U, 256U}) CHECK(all_are(plain.run_row(n).estimates, 1));
  for (const std::uint64_t n : {512U, 1024U}) CHECK(all_are(plain.run_row(n).estimates, 0));
}

TEST_CASE("randomly shifted lattices that alias have a mean square error of 1/2 at every N",
          "[statistical]") {
  // cos^2 of a uniform angle: mean 1/2, variance 1/8; 6 standard errors, false alarm 2e-9.
  constexpr std::uint32_t kReplicates = 2048;
  PreparedCell shifted =
      prepare("lattice-alias:m=8", "lattice-shift", Precision::fp64, kReplicates);
  const std::vector<double> first = shifted.run_row(16).estimates;
  double square = 0;
  for (const double q : first) square += q * q / kReplicates;
  CHECK(std::fabs(square - 0.5) < 6 * std::sqrt(0.125 / kReplicates));
  const std::vector<double> last = shifted.run_row(256).estimates;
  for (std::uint32_t r = 0; r < kReplicates; ++r) CHECK(std::fabs(last[r] - first[r]) < 1e-9);
}

TEST_CASE("a sum beyond the range of its precision still has its exact mean", "[device]") {
  // Multiples of 1/N in [1,2), scaled: nothing rounds, so the mean of N = 2^m is 1.5 - 2^-(m+1).
  const NetSum huge = sum_of_net("scale:e=1010", Precision::fp64, 1 << 14);
  CHECK(std::isinf(huge.sum));
  CHECK(huge.mean == std::ldexp(1.5 - 0x1p-15, 1010));
  const NetSum single = sum_of_net("scale:e=120", Precision::fp32, 1 << 8);
  CHECK(single.sum > static_cast<double>(FLT_MAX));
  CHECK(single.mean == std::ldexp(1.5 - 0x1p-9, 120));
}

TEST_CASE("denormal samples have their exact mean where the device keeps them", "[device]") {
  CHECK(sum_of_net("scale:e=-140", Precision::fp32, 1 << 8).mean == std::ldexp(1.5 - 0x1p-9, -140));
  CHECK(sum_of_net("scale:e=-1060", Precision::fp64, 1 << 12).mean ==
        std::ldexp(1.5 - 0x1p-13, -1060));
  // The stored value (integrals.json, scale_fp64_denormal), which is denormal itself.
  const PreparedCell prepared = prepare("scale:e=-1060", "sobol", Precision::fp64);
  CHECK(*prepared.exact().mean == 0x0.0000000006p-1022);
  CHECK_FALSE(prepared.exact().variance);
}

TEST_CASE("the sampled variance of c + x is 1/12 whatever c, that of a constant exactly 0",
          "[statistical]") {
  // Of 2^14 values, whose fourth moment 1/80 gives a standard error of 5.8e-4: 8 of them.
  constexpr std::uint32_t kSamples = 1 << 14;
  for (const auto& [scene, precision] : {std::pair{"variance-cancel:c=1e8", Precision::fp64},
                                         {"variance-cancel:c=-1e8", Precision::fp64},
                                         {"variance-cancel:c=1e4", Precision::fp32}}) {
    const Row row = prepare(scene, "random", precision, 1, "mc").run_row(kSamples);
    const double variance = std::pow(*row.estimate.standard_error, 2) * kSamples;
    INFO(scene << ": " << variance);
    CHECK(std::fabs(variance - 1.0 / 12) < 8 * 5.8e-4);
  }
  const Row row =
      prepare("constant-value:value=0.1", "random", Precision::fp64, 1, "mc").run_row(4096);
  CHECK(*row.estimate.standard_error == 0);
}

TEST_CASE("a naive form is not finite at exactly the points where it overflows", "[device]") {
  // exp overflows from 709.782712893384 on (ln of DBL_MAX).
  constexpr double kOverflow = 709.782712893384;
  constexpr std::uint64_t kPoints = 4096;
  const auto beyond = [&](std::uint32_t dim) {
    const auto x = test::points({.sampler = "sobol-owen", .dim = dim, .count = kPoints});
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const auto coordinates = std::span(x).subspan(i * dim, dim);
      count += *std::max_element(coordinates.begin(), coordinates.end()) * 1000 > kOverflow ? 1 : 0;
    }
    return count;
  };
  const auto nonfinite = [&](const std::string& scene) {
    return prepare(scene, "sobol-owen", Precision::fp64).run_row(kPoints).nonfinite;
  };
  CHECK(nonfinite("singular-perturbed-bvp:form=naive,eps=0.001") == beyond(1));
  CHECK(nonfinite("logsumexp:form=naive,c=1000") == beyond(2));
  CHECK(nonfinite("prod-scaled-order:form=naive,d=250") == kPoints);
  for (const char* stable :
       {"singular-perturbed-bvp:eps=0.001", "logsumexp:c=1000", "prod-scaled-order:d=250"})
    CHECK(nonfinite(stable) == 0);
}
