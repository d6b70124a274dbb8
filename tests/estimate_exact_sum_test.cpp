// Exact sums: correctly rounded, order-free, honest about non-finite terms.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "estimate/exact_sum.hpp"
#include "tests/numbers.hpp"

namespace koksma {
namespace {

using test::kInfinity;
using test::kNan;

__extension__ using Quad = __float128;

constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();

double sum_of(const std::vector<double>& terms) {
  ExactSum sum;
  sum.add(terms);
  return sum.rounded();
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Any finite double: random mantissa and sign, exponent field in [low, high].
double random_double(std::mt19937_64& engine, unsigned low = 0, unsigned high = 2046) {
  std::uniform_int_distribution<std::uint64_t> exponent(low, high);
  const std::uint64_t rest = engine() & 0x800fffffffffffffU;
  return std::bit_cast<double>(rest | exponent(engine) << 52U);
}

}  // namespace

TEST_CASE("exact sums equal quad-precision sums where those are exact", "[unit][estimate]") {
  std::mt19937_64 engine(1);
  for (int trial = 0; trial < 2000; ++trial) {
    // 53 bits of mantissa, 40 of exponent range and 6 of carries stay below the 113 bits of a quad.
    std::uniform_int_distribution<unsigned> base(1, 2000);
    const unsigned low = base(engine);
    ExactSum sum;
    Quad quad = 0;
    for (int i = 0; i < 60; ++i) {
      const double term = random_double(engine, low, low + 40);
      sum.add(term);
      quad += static_cast<Quad>(term);
    }
    REQUIRE(same_bits(sum.rounded(), static_cast<double>(quad)));
  }
}

TEST_CASE("many terms at once are summed as one by one, whatever their sizes", "[unit][estimate]") {
  std::mt19937_64 engine(4);
  const auto check = [](const std::vector<double>& terms) {
    ExactSum at_once, one_by_one;
    at_once.add(terms);
    for (const double term : terms) one_by_one.add(term);
    CHECK(same_bits(at_once.rounded(), one_by_one.rounded()));
    CHECK(at_once.nonfinite() == one_by_one.nonfinite());
    // Every bit, not the leading ones alone.
    at_once.subtract(one_by_one);
    if (one_by_one.nonfinite() == 0) CHECK(at_once.rounded() == 0);
  };
  // Exponents 0 to 40 apart come out in two parts, wider ranges do not; the lowest are denormal,
  // the highest overflow on the way.
  for (const unsigned low : {0U, 1U, 200U, 1000U, 1800U, 1980U})
    for (const unsigned range : {0U, 3U, 40U, 52U, 53U, 54U, 66U})
      for (const std::size_t count : {31U, 32U, 33U, 64U, 1000U, 1023U, 1024U}) {
        std::vector<double> terms(count);
        for (double& term : terms) term = random_double(engine, low, low + range);
        check(terms);
      }
  std::vector<double> terms(64, 1.0);
  for (const double odd : {0.0, -0.0, kTiny, -kTiny, kMax, kInfinity, -kInfinity, kNan})
    for (const std::size_t place : {0U, 31U, 63U}) {
      std::vector<double> with = terms;
      with[place] = odd;
      check(with);
    }
  check(std::vector<double>(64, 0.0));
  check(std::vector<double>(4096, std::nextafter(1.0, 2.0)));
}

TEST_CASE("one term comes back unchanged, whatever its exponent", "[unit][estimate]") {
  std::mt19937_64 engine(2);
  for (int trial = 0; trial < 20000; ++trial) {
    const double term = random_double(engine);
    REQUIRE(same_bits(sum_of({term}), term));
  }
  for (const double term : {kTiny, 3 * kTiny, 0x1p-1022, 0x1p-1022 - kTiny, kMax, -kMax, -kTiny}) {
    CHECK(same_bits(sum_of({term}), term));
  }
}

TEST_CASE("sums do not depend on order, grouping or cancelled terms", "[unit][estimate]") {
  std::mt19937_64 engine(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> terms;
    for (int i = 0; i < 100; ++i) terms.push_back(random_double(engine, 0, 2030));
    const double expected = sum_of(terms);
    std::shuffle(terms.begin(), terms.end(), engine);
    REQUIRE(same_bits(sum_of(terms), expected));

    // Three partial sums, merged in both directions, with noise that cancels.
    ExactSum parts[3];
    for (std::size_t i = 0; i < terms.size(); ++i) parts[engine() % 3].add(terms[i]);
    const double noise = random_double(engine);
    parts[0].add(noise);
    ExactSum forward = parts[0];
    forward.add(parts[1]);
    forward.add(parts[2]);
    forward.subtract(noise);
    ExactSum backward;
    for (int k = 2; k >= 0; --k) backward.add(parts[k]);
    backward.subtract(noise);
    REQUIRE(same_bits(forward.rounded(), expected));
    REQUIRE(same_bits(backward.rounded(), expected));
    forward.subtract(backward);
    REQUIRE(same_bits(forward.rounded(), 0.0));
  }
}

TEST_CASE("catastrophic cancellation and overflow on the way leave exact results",
          "[unit][estimate]") {
  CHECK(sum_of({1e16, 1, -1e16}) == 1);
  CHECK(sum_of({1, 1e30, 1, -1e30}) == 2);
  CHECK(sum_of({1e308, 1e308, 1e308, -1e308, -1e308, 1}) == 1e308);
  CHECK(sum_of({kMax, kMax, -kMax, kTiny, -kMax}) == kTiny);
  CHECK(sum_of({-kTiny, 1, -1}) == -kTiny);
  CHECK(sum_of({1e308, 1e308}) == kInfinity);
  CHECK(sum_of({-1e308, -1e308}) == -kInfinity);
  CHECK(same_bits(sum_of({}), 0.0));
  CHECK(same_bits(sum_of({-1.0, 1.0}), 0.0));
}

TEST_CASE("rounding is to nearest, ties to even, from the last bit far below", "[unit][estimate]") {
  CHECK(sum_of({1, 0x1p-53}) == 1);
  CHECK(sum_of({1 + 0x1p-52, 0x1p-53}) == 1 + 0x1p-51);
  CHECK(sum_of({1, 0x1p-53, kTiny}) == 1 + 0x1p-52);
  CHECK(sum_of({1, 0x1p-53, -kTiny}) == 1);
  CHECK(sum_of({-1, -0x1p-53, -kTiny}) == -1 - 0x1p-52);
  CHECK(sum_of({2, -0x1p-53}) == 2);
  CHECK(sum_of({2, -0x1p-53, -kTiny}) == 2 - 0x1p-52);
  // The tie between the largest double and 2^1024 rounds to infinity, anything less does not.
  CHECK(sum_of({kMax, 0x1p970}) == kInfinity);
  CHECK(sum_of({kMax, 0x1p970, -kTiny}) == kMax);
}

TEST_CASE("repeated doubling carries through every digit", "[unit][estimate]") {
  for (const double term : {0.1, -0.3, 1e-320, -5e-324, 0x1.fffffffffffffp900}) {
    ExactSum sum;
    sum.add(term);
    for (int k = 0; k < 60; ++k) {
      const ExactSum copy = sum;
      sum.add(copy);
    }
    CHECK(sum.rounded() == std::ldexp(term, 60));
    sum.subtract(std::ldexp(term, 60));
    CHECK(sum.rounded() == 0);
  }
}

TEST_CASE("non-finite terms are counted and dominate as in IEEE sums", "[unit][estimate]") {
  CHECK(sum_of({1, kInfinity, -kMax}) == kInfinity);
  CHECK(sum_of({-kInfinity, kMax}) == -kInfinity);
  CHECK(std::isnan(sum_of({kInfinity, 1, -kInfinity})));
  CHECK(std::isnan(sum_of({kNan, 1})));
  ExactSum sum;
  sum.add(std::vector<double>{kNan, kInfinity, 2, -kInfinity, -kInfinity});
  CHECK(sum.nonfinite() == 4);
  CHECK(std::isnan(sum.rounded_quotient(5)));

  ExactSum infinite;
  infinite.add(kInfinity);
  ExactSum difference;
  difference.subtract(infinite);
  CHECK(difference.rounded() == -kInfinity);
  difference.add(infinite);
  CHECK(std::isnan(difference.rounded()));
}

TEST_CASE("quotients are correctly rounded like one IEEE division", "[unit][estimate]") {
  std::mt19937_64 engine(4);
  for (int trial = 0; trial < 20000; ++trial) {
    const double term = random_double(engine, 0, trial % 2 == 0 ? 2046 : 60);
    const std::uint64_t count = 1 + (engine() >> (11 + engine() % 50));
    ExactSum sum;
    sum.add(term);
    REQUIRE(same_bits(sum.rounded_quotient(count), term / static_cast<double>(count)));
  }
  // Above a tie by less than 2^-64 of the last bit: only the remainder of the division tells.
  ExactSum sum;
  sum.add_product(kTiny, (std::uint64_t{1} << 62U) + 1);
  CHECK(sum.rounded_quotient((std::uint64_t{1} << 63U) + 1) == kTiny);
  CHECK(sum.rounded_quotient((std::uint64_t{1} << 63U) + 2) == 0);
  CHECK_THROWS_AS(ExactSum().rounded_quotient(0), std::invalid_argument);
}

TEST_CASE("the mean of huge values is finite although their sum is not", "[unit][estimate]") {
  ExactSum sum;
  const std::uint64_t count = std::uint64_t{1} << 16U;
  for (std::uint64_t i = 0; i < count; ++i) sum.add(i % 2 == 0 ? 0x1p1010 : 0x1.8p1010);
  CHECK(sum.rounded() == kInfinity);
  CHECK(sum.rounded_quotient(count) == 0x1.4p1010);
  sum.add_product(kMax, std::numeric_limits<std::uint64_t>::max());
  sum.add_product(-0x1p1010, count);
  sum.add_product(-0x1p1008, count);
  CHECK(sum.rounded_quotient(std::numeric_limits<std::uint64_t>::max()) == kMax);
}

TEST_CASE("products with a count are exact", "[unit][estimate]") {
  std::mt19937_64 engine(5);
  for (int trial = 0; trial < 20000; ++trial) {
    // Away from the denormals, where fma could not give the rounding error of the product.
    const double factor = random_double(engine, 100, 1900);
    const std::uint64_t count = engine() >> (11 + engine() % 50);
    const auto real_count = static_cast<double>(count);
    ExactSum sum;
    sum.add_product(factor, count);
    REQUIRE(sum.rounded() == factor * real_count);
    sum.subtract(factor * real_count);
    REQUIRE(sum.rounded() == std::fma(factor, real_count, -factor * real_count));
  }
  for (const double factor : {kTiny, -kTiny, 1e-310, -0.1}) {
    ExactSum sum;
    sum.add_product(factor, std::uint64_t{1} << 63U);
    CHECK(sum.rounded() == std::ldexp(factor, 63));
  }
  ExactSum sum;
  sum.add_product(kInfinity, 0);
  CHECK(std::isnan(sum.rounded()));
}

}  // namespace koksma
