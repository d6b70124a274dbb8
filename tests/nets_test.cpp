// Base-2 nets, lattices and Kronecker sequences equal their definitions, computed here in other
// ways.
#include <fmt/format.h>

#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <boost/random/niederreiter_base2.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "points/kronecker.hpp"
#include "points/matrices.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;
using koksma::test::points;
using koksma::test::word52;

namespace {

// The text of matrices in LDData's dnet format, 32 bits.
std::string dnet(const GeneratingMatrices& m) {
  std::string text = fmt::format(
      "# dnet\n2  # base\n{} # dimensions\n{} # points\n32 # bits\n# columns, one matrix per "
      "line\n",
      m.dim, std::uint64_t{1} << m.columns);
  for (std::uint32_t d = 0; d < m.dim; ++d) {
    for (std::uint32_t k = 0; k < m.columns; ++k)
      text += fmt::format("{} ", m.words[std::size_t{k} * m.dim + d] >> 32);
    text += "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("Niederreiter points are Boost's, after the zero point, from any start", "[device]") {
  for (const std::uint64_t start : {1ULL, 1000ULL, (1ULL << 32) - 7, (1ULL << 40) + 12345}) {
    const auto drawn = points({.sampler = "niederreiter", .dim = 20, .start = start, .count = 64});
    boost::random::niederreiter_base2_engine<std::uint64_t, 64> engine(20);
    engine.seed(start - 1);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      INFO("start " << start << " value " << i);
      REQUIRE(word52(drawn[i]) == engine() >> 12);
    }
  }
}

TEST_CASE("the base-2 Hammersley net has i/N, in Gray order, before a Sobol' sequence",
          "[device]") {
  const auto sequence = points({.sampler = "sobol", .dim = 4, .count = 4096});
  for (const unsigned m : {1U, 3U, 4U, 12U}) {
    const std::uint64_t n = 1ULL << m;
    const auto drawn = points({.sampler = "hammersley-2", .dim = 5, .count = n, .n = n});
    for (std::uint64_t i = 0; i < n; ++i) {
      INFO("N " << n << " point " << i);
      REQUIRE(drawn[5 * i] == std::ldexp(static_cast<double>(i ^ i >> 1), -static_cast<int>(m)));
      for (std::uint64_t j = 0; j < 4; ++j) REQUIRE(drawn[5 * i + 1 + j] == sequence[4 * i + j]);
    }
  }
}

TEST_CASE("a file of generating matrices gives the net it describes, and says where it is wrong",
          "[device]") {
  const test::TemporaryFolder folder;
  const std::string good = dnet(sobol_matrices(6, 12));
  const std::string path = folder.write("net.txt", good);
  for (const char* suffix : {"", "-shift", "-lms-shift", "-owen"}) {
    INFO(suffix);
    const auto own = points({.sampler = fmt::format("matrices{}:path={}", suffix, path),
                             .dim = 6,
                             .count = 4096,
                             .replicate = 1});
    // 32 bits of the columns: more than 12 columns and 52 bits can tell from Sobol's own.
    CHECK(
        own ==
        points(
            {.sampler = fmt::format("sobol{}", suffix), .dim = 6, .count = 4096, .replicate = 1}));
  }
  const auto refusal = [&](const std::string& text, std::uint32_t dim, std::uint64_t end) {
    try {
      matrices_from_file(folder.write("bad.txt", text), dim, end, 12);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(refusal(good, 6, 4096).empty());
  CHECK_THAT(refusal(good, 7, 16),
             Contains("matrices for 6 dimensions") && Contains("7 are drawn"));
  CHECK_THAT(refusal(good, 6, 4097), Contains("matrices for 4096 points; 4097 are drawn"));
  CHECK_THAT(refusal("# x\n3\n", 1, 2), Contains("bad.txt:2: 3; the base, 2, comes here"));
  CHECK_THAT(refusal("2\n1\n5\n", 1, 2), Contains("bad.txt:3: 5 points; a power of two"));
  CHECK_THAT(refusal("2\n1\n4\n65\n", 1, 2), Contains("bad.txt:4: 65"));
  CHECK_THAT(refusal("2\n1\n4\n3\n4 two\n", 1, 2), Contains("bad.txt:5: 'two'; whole numbers"));
  CHECK_THAT(refusal("2\n1\n4\n3\n4 -2\n", 1, 2), Contains("bad.txt:5: '-2'; whole numbers"));
  CHECK_THAT(refusal("2\n1\n4\n3\n4\n", 1, 2), Contains("bad.txt:5: 1 columns; 2^2 points have 2"));
  CHECK_THAT(refusal("2\n1\n4\n3\n4 8\n", 1, 2), Contains("column 2 is 8; an integer has 3 bits"));
  CHECK_THAT(refusal("2\n1\n4\n", 1, 2), Contains("the file ends too early"));
  CHECK_THROWS_WITH(matrices_from_file(folder.path("none"), 1, 2, 4), Contains("cannot be read"));
}

TEST_CASE("an interlaced coordinate holds the digits of its nested-scrambled components in turn",
          "[device]") {
  std::size_t samplers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::has_property(s, "interlaced")) continue;
    ++samplers;
    const std::uint32_t order = s.options["interlace"], dim = 3;
    for (const std::uint32_t r : {0U, 5U}) {
      const auto drawn = points({.sampler = s.name, .dim = dim, .count = 256, .replicate = r});
      const auto parts =
          points({.sampler = "sobol-owen", .dim = order * dim, .count = 256, .replicate = r});
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        const std::uint64_t word = word52(drawn[i]);
        for (std::uint32_t digit = 0; digit < 52; ++digit) {
          const std::uint64_t part = word52(parts[i * order + digit % order]);
          INFO(s.name << " value " << i << " digit " << digit);
          REQUIRE((word >> (51 - digit) & 1) == (part >> (51 - digit / order) & 1));
        }
      }
    }
  }
  CHECK(samplers == 2);
}

TEST_CASE("the tent lattice is the baker's transform of the shifted lattice", "[device]") {
  std::size_t samplers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::has_property(s, "lattice-tent")) continue;
    ++samplers;
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      const double unit = precision == Precision::fp32 ? 0x1p-23 : 0x1p-52;
      // 20 dimensions: the other of the two ways to keep the state.
      for (const std::uint32_t dim : {5U, 20U}) {
        const auto folded = points(
            {.sampler = s.name, .dim = dim, .precision = precision, .count = 512, .replicate = 1});
        const auto shifted = points({.sampler = "lattice-shift",
                                     .dim = dim,
                                     .precision = precision,
                                     .count = 512,
                                     .replicate = 1});
        for (std::size_t i = 0; i < folded.size(); ++i)
          REQUIRE(std::fabs(1 - std::fabs(2 * shifted[i] - 1) - folded[i]) <= unit / 2);
      }
    }
  }
  CHECK(samplers == 1);
}

TEST_CASE("random generating vectors are odd and differ between replicates and dimensions",
          "[device]") {
  std::size_t samplers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::has_property(s, "rank-1-lattice") || s.options["vector"] != "drawn") continue;
    ++samplers;
    const std::uint32_t dim = 5, m = 20;
    std::set<std::uint64_t> components;
    for (std::uint32_t r = 0; r < 16; ++r) {
      // Gray code of index i is 2^19: phi_2 of it is 2^-20, so that point is the shift plus z
      // 2^-20.
      const std::uint64_t i = (1ULL << m) - 1;
      const auto first = points({.sampler = s.name, .dim = dim, .count = 1, .replicate = r});
      const auto point =
          points({.sampler = s.name, .dim = dim, .start = i, .count = 1, .replicate = r});
      for (std::uint32_t j = 0; j < dim; ++j) {
        const double difference = point[j] - first[j];
        const double z = std::ldexp(difference - std::floor(difference), static_cast<int>(m));
        INFO("replicate " << r << " dimension " << j << ": " << z);
        REQUIRE(z == std::floor(z));
        REQUIRE(static_cast<std::uint64_t>(z) % 2 == 1);
        components.insert(static_cast<std::uint64_t>(z));
      }
    }
    CHECK(components.size() > 75);  // of 80 among 2^19
  }
  CHECK(samplers == 1);
}

TEST_CASE(
    "the irrationals are roots of primes and powers of the generalised golden ratio to 64 bits",
    "[unit]") {
  using boost::multiprecision::cpp_int;
  const auto roots = kronecker_fractions("root-of-prime", 4);
  const std::uint32_t primes[] = {2, 3, 5, 7}, whole[] = {1, 1, 2, 2};
  for (std::size_t j = 0; j < 4; ++j) {
    const cpp_int root = (cpp_int(whole[j]) << 64) + roots[j], square = cpp_int(primes[j]) << 128;
    CHECK(root * root <= square);
    CHECK((root + 1) * (root + 1) > square);
  }
  CHECK(kronecker_fractions("root-of-prime", 200).size() == 200);
  for (const std::uint32_t d : {1U, 2U, 3U, 10U, 300U}) {
    using Real = boost::multiprecision::cpp_bin_float_50;
    const auto alpha = kronecker_fractions("generalised-golden-ratio", d);
    // 1 = alpha_1^d + alpha_1^(d+1), and alpha_j = alpha_1^j.
    const Real a = (Real(alpha[0]) + 0.5) * boost::multiprecision::ldexp(Real(1), -64);
    INFO("d = " << d);
    CHECK(boost::multiprecision::fabs(boost::multiprecision::pow(a, d) * (1 + a) - 1) < d * 2e-19);
    for (std::uint32_t j = 0; j < d; ++j)
      CHECK(boost::multiprecision::fabs(boost::multiprecision::ldexp(Real(alpha[j]), -64) -
                                        boost::multiprecision::pow(a, j + 1)) < (j + 2) * 6e-20);
  }
}

TEST_CASE("Kronecker points are the multiples of their irrationals modulo 1, in natural order",
          "[device]") {
  std::size_t samplers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::has_property(s, "kronecker")) continue;
    ++samplers;
    const std::uint32_t replicate = s.replicable ? 2 : 0;
    // 20 dimensions: fp32 keeps its state in another way there.
    for (const std::uint32_t dim : {5U, 20U}) {
      const auto alpha = kronecker_fractions(s.options["alpha"], dim);
      const auto shift =
          points({.sampler = s.name, .dim = dim, .count = 1, .replicate = replicate});
      for (const std::uint64_t start : {0ULL, 1000ULL, (1ULL << 32) - 40, (1ULL << 51) + 12345}) {
        const auto drawn = points(
            {.sampler = s.name, .dim = dim, .start = start, .count = 200, .replicate = replicate});
        for (std::size_t i = 0; i < drawn.size(); ++i) {
          const std::uint64_t multiple = (start + i / dim) * alpha[i % dim];
          // The shift is known to 52 bits: its other bits may carry.
          const std::uint64_t sum = (multiple >> 12) + word52(shift[i % dim]);
          const std::uint64_t error = (word52(drawn[i]) - sum) & ((1ULL << 52) - 1);
          INFO(s.name << " d = " << dim << " start " << start << " value " << i);
          REQUIRE(error <= (s.replicable ? 1 : 0));
        }
      }
    }
    for (const std::uint64_t start : {0ULL, (1ULL << 32) - 400}) {
      // fp32 in many dimensions adds carries: equal to fp64 at 23 bits.
      if (!s.replicable && start > 0) continue;  // exact points end at 2^23 in fp32
      const auto fine = points({.sampler = s.name, .dim = 20, .start = start, .count = 4096});
      const auto coarse = points({.sampler = s.name,
                                  .dim = 20,
                                  .precision = Precision::fp32,
                                  .start = start,
                                  .count = 4096});
      for (std::size_t i = 0; i < fine.size(); ++i)
        REQUIRE(std::floor(std::ldexp(fine[i], 23)) == std::floor(std::ldexp(coarse[i], 23)));
    }
  }
  CHECK(samplers == 3);
}
