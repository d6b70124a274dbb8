// Every sum of the catalog, as the device computes it, against exact arithmetic on terms chosen to
// break it: its stated bound, its stated order-freedom, and non-finite terms that must show.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "estimate/summation.hpp"
#include "stability/self_test.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::kInfinity;
using koksma::test::kNan;

namespace {

std::vector<const SumAlgorithm*> all_sums() {
  std::vector<const SumAlgorithm*> sums;
  for (const SumAlgorithm& sum : test::catalog().sums) sums.push_back(&sum);
  return sums;
}

// All sums in one program per precision.
SelfTestProgram program(Precision precision) {
  return {test::device(), "eft", all_sums(), precision, ""};
}

// A precision's numbers 2^low … 2^high and the limits of its range.
struct Range {
  Precision precision;
  int digits, lowest, highest;  // exponents of the least denormal and of the largest power of two
  double largest;

  double rounded(double x) const {
    return precision == Precision::fp64 ? x : static_cast<double>(static_cast<float>(x));
  }
};
const Range kFp32{Precision::fp32, 24, -149, 127, std::numeric_limits<float>::max()};
const Range kFp64{Precision::fp64, 53, -1074, 1023, std::numeric_limits<double>::max()};

// Terms with exponents uniform over [low, high] and random signs.
std::vector<double> random_terms(std::mt19937_64& engine, const Range& range, int low, int high,
                                 std::size_t count) {
  std::uniform_real_distribution<double> mantissa(1, 2);
  std::uniform_int_distribution<int> exponent(low, high);
  std::vector<double> terms;
  while (terms.size() < count) {
    const double x = range.rounded(std::ldexp(mantissa(engine), exponent(engine)));
    terms.push_back((engine() & 1) != 0 ? x : -x);
  }
  return terms;
}

// Terms whose large parts cancel exactly, in random order.
std::vector<double> cancelling_terms(std::mt19937_64& engine, const Range& range) {
  std::vector<double> terms = random_terms(engine, range, 0, range.digits, 60);
  for (std::size_t i = 0; i < 60; ++i) terms.push_back(-terms[i]);
  for (const double small : random_terms(engine, range, -range.digits / 2, 0, 8))
    terms.push_back(small);
  std::shuffle(terms.begin(), terms.end(), engine);
  return terms;
}

ExactSum exact_sum(const std::vector<double>& terms) {
  ExactSum sum;
  sum.add(terms);
  return sum;
}

double difference(ExactSum a, const ExactSum& b) {
  a.subtract(b);
  return std::fabs(a.rounded());
}

// |error| <= bound sum|x|; what a sum can not represent at all must come out as NaN.
void check_bound(SelfTestProgram& device, const Range& range, const std::vector<double>& terms) {
  const ExactSum exact = exact_sum(terms);
  double total_abs = 0, largest = 0;
  for (const double x : terms) {
    total_abs += std::fabs(x);
    largest = std::max(largest, std::fabs(x));
  }
  const auto n = static_cast<std::uint32_t>(terms.size());
  const auto sums = all_sums();
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const SumAlgorithm& sum = *sums[k];
    INFO(sum.name << " " << precision_name(range.precision) << " n " << n << " sum|x| "
                  << total_abs);
    const ExactSum got = device.add_up(k, terms, n);
    if (sum.quantum > 0 && largest >= 0x1p31) {
      CHECK(std::isnan(got.rounded()));
      continue;
    }
    const double bound = n * summation_bound(sum, range.precision, n).of(total_abs / n);
    CHECK(difference(got, exact) <= bound * (1 + 1e-3));
  }
}

}  // namespace

TEST_CASE("every sum keeps its stated bound on terms of all sizes, cancelling and denormal ones",
          "[device]") {
  std::mt19937_64 engine(1);
  for (const Range& range : {kFp32, kFp64}) {
    SelfTestProgram device = program(range.precision);
    for (int trial = 0; trial < 5; ++trial) {
      check_bound(device, range, random_terms(engine, range, -4, 4, 1000));
      check_bound(device, range, random_terms(engine, range, -60, 30, 333));
      check_bound(device, range, cancelling_terms(engine, range));
      check_bound(device, range, random_terms(engine, range, range.lowest, range.lowest + 20, 100));
      check_bound(device, range,
                  random_terms(engine, range, range.highest - 20, range.highest - 10, 100));
      check_bound(device, range,
                  random_terms(engine, range, range.lowest, range.highest - 10, 100));
    }
    check_bound(device, range, {1, range.rounded(1e30), 1, -range.rounded(1e30)});
    check_bound(device, range, {0.0, -0.0, 0.0});
  }
}

TEST_CASE("order-free sums give the same in any order, and only exact ones exceed the range",
          "[device]") {
  std::mt19937_64 engine(2);
  const auto sums = all_sums();
  for (const Range& range : {kFp32, kFp64}) {
    SelfTestProgram device = program(range.precision);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const SumAlgorithm& sum = *sums[k];
      INFO(sum.name << " " << precision_name(range.precision));
      std::vector<double> terms = random_terms(engine, range, -70, 30, 1111);
      const ExactSum first = device.add_up(k, terms, 1111);
      std::size_t changed = 0;
      for (int trial = 0; trial < 4; ++trial) {
        std::shuffle(terms.begin(), terms.end(), engine);
        changed += difference(device.add_up(k, terms, 1111), first) != 0 ? 1 : 0;
      }
      if (sum.order_free) CHECK(changed == 0);
      // Naive sums do change: the data can tell.
      if (sum.words(false) == 1 && !sum.needs_fp64) CHECK(changed > 0);

      // 2^12 times the largest number: the mean is in range, the sum is not.
      const bool exact = sum.bound.empty() && sum.quantum == 0;
      const ExactSum huge = device.add_up(k, {range.largest}, 1 << 12);
      if (exact) {
        CHECK(huge.rounded_quotient(1 << 12) == range.largest);
        CHECK(device.add_up(k, {range.largest, range.largest, -range.largest, 1}, 1 << 12)
                  .rounded_quotient(1 << 10) == range.largest);
      } else if (sum.quantum > 0) {
        CHECK(std::isnan(huge.rounded()));
      }
    }
  }
}

TEST_CASE("a NaN or infinite term is never lost, and exact sums tell them apart as IEEE sums do",
          "[device]") {
  const auto sums = all_sums();
  for (const Range& range : {kFp32, kFp64}) {
    SelfTestProgram device = program(range.precision);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const SumAlgorithm& sum = *sums[k];
      INFO(sum.name << " " << precision_name(range.precision));
      for (const double fault : {kNan, -kNan, kInfinity, -kInfinity}) {
        for (const std::size_t place : {0U, 1U, 6U}) {
          std::vector<double> terms{1, 2, 3, -4, 5, 6, 7};
          terms[place] = fault;
          CHECK(device.add_up(k, terms, 7).nonfinite() > 0);
          CHECK_FALSE(std::isfinite(device.add_up(k, terms, 7000).rounded()));
        }
      }
      if (!sum.bound.empty() || sum.quantum > 0) continue;
      CHECK(device.add_up(k, {1, kInfinity, 2}, 3).rounded() == kInfinity);
      CHECK(device.add_up(k, {1, -kInfinity, -kInfinity}, 3).rounded() == -kInfinity);
      CHECK(std::isnan(device.add_up(k, {kInfinity, 1, -kInfinity}, 3).rounded()));
      CHECK(std::isnan(device.add_up(k, {kInfinity, kNan}, 2).rounded()));
    }
  }
}

TEST_CASE("fixed sums refuse samples from 2^31 on and round each below to a multiple of 2^-62",
          "[device]") {
  const auto sums = all_sums();
  for (const Range& range : {kFp32, kFp64}) {
    SelfTestProgram device = program(range.precision);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      if (!(sums[k]->quantum > 0)) continue;
      const double most = std::nextafter(0x1p31, 0);
      const double below = range.precision == Precision::fp64
                               ? most
                               : static_cast<double>(std::nextafter(0x1p31F, 0.0F));
      for (const double sign : {1.0, -1.0}) {
        CHECK(device.add_up(k, {sign * below}, 1000).rounded_quotient(1000) == sign * below);
        CHECK(std::isnan(device.add_up(k, {1, sign * 0x1p31, 1}, 3).rounded()));
        CHECK(device.add_up(k, {sign * 0x1.8p-62}, 1).rounded() == sign * 0x1p-61);
        CHECK(device.add_up(k, {sign * 0x1.2p-62}, 64).rounded() == sign * 0x1p-56);
        CHECK(device.add_up(k, {sign * 0x1p-64}, 64).rounded() == 0);
      }
    }
  }
}

TEST_CASE("bounds and estimates of summation are those of the literature", "[unit]") {
  const auto bound = [](const char* sum, Precision precision, double n) {
    return summation_bound(test::catalog().sum(sum, "test"), precision, n);
  };
  // Higham 1993: n u; a double sum of fp32 samples has the roundoff of doubles.
  CHECK(bound("naive", Precision::fp32, 1 << 20).of(2) == 2 * 0x1p-4);
  CHECK(bound("double", Precision::fp32, 1 << 20).of(1) == 0x1p-33);
  CHECK(bound("kahan", Precision::fp64, 1 << 20).of(1) == Approx(0x1p-52).epsilon(1e-9));
  // Ogita, Rump & Oishi 2005: useless in fp32 from 2^24 terms on, harmless in fp64.
  CHECK(bound("neumaier", Precision::fp32, 1 << 26).of(1) == 1);
  CHECK(bound("neumaier", Precision::fp64, 1 << 26).of(1) == 0x1p-54);
  CHECK(bound("double-float", Precision::fp32, 1 << 26).of(1) == 0x1p-21);
  // Independent of the size of f; and none at all.
  CHECK(bound("fixed", Precision::fp64, 100).of(1e6) == 0x1p-63);
  CHECK(bound("superaccumulator", Precision::fp32, 1 << 30).of(1e6) == 0);
  for (const SumAlgorithm& sum : test::catalog().sums)
    for (const Precision precision : {Precision::fp32, Precision::fp64})
      for (const double n : {0.0, 1.0, 16.0, 4096.0, 0x1p20, 0x1p30}) {
        const SummationError worst = summation_bound(sum, precision, n);
        const SummationError typical = summation_estimate(sum, precision, n);
        INFO(sum.name << " n " << n);
        CHECK(typical.of(1) <= worst.of(1));
        CHECK(worst.relative <= 1);
      }
}
