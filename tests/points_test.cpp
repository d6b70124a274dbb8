// The points that the kernels draw equal their definitions.
#include <Random123/philox.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <boost/random/sobol.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "catalog/embedded.hpp"
#include "points/matrices.hpp"
#include "points/tables.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::points;
using koksma::test::PointsSpec;

namespace {

// Point `index` of Boost's Sobol' engine in the order that begins with the zero point, as 64-bit
// fractions.
std::vector<std::uint64_t> boost_point(std::uint32_t dim, std::uint64_t index) {
  std::vector<std::uint64_t> result(dim, 0);
  if (index == 0) return result;
  boost::random::sobol_engine<std::uint64_t, 64> engine(dim);
  engine.seed(index - 1);
  for (auto& x : result) x = engine();
  return result;
}

double fraction52(std::uint64_t word) { return std::ldexp(static_cast<double>(word >> 12), -52); }

}  // namespace

TEST_CASE("the first 2^12 points of sobol in 50 dimensions are Boost's, after the zero point",
          "[device]") {
  const auto drawn = points({.sampler = "sobol", .dim = 50, .count = 4096});
  boost::random::sobol_engine<std::uint64_t, 64> engine(50);
  for (std::size_t j = 0; j < 50; ++j) REQUIRE(drawn[j] == 0);
  for (std::size_t i = 50; i < drawn.size(); ++i) REQUIRE(drawn[i] == fraction52(engine()));
}

TEST_CASE("sobol from any start equals Boost's point of that index, also beyond 2^32", "[device]") {
  for (const std::uint64_t start :
       {1ULL, 5ULL, 15ULL, 16ULL, 17ULL, 1000ULL, (1ULL << 20) + 3, (1ULL << 31) - 5,
        (1ULL << 32) - 7, (1ULL << 32) + 11, (1ULL << 40) + 12345}) {
    const auto drawn = points({.sampler = "sobol", .dim = 7, .start = start, .count = 40});
    for (std::uint64_t i = 0; i < 40; ++i) {
      const auto expected = boost_point(7, start + i);
      for (std::size_t j = 0; j < 7; ++j) {
        INFO("start " << start << " point " << i << " dimension " << j);
        REQUIRE(drawn[i * 7 + j] == fraction52(expected[j]));
      }
    }
  }
}

TEST_CASE("sobol in the last tabulated dimension equals Boost's", "[device]") {
  const std::uint32_t dim = 3667;
  const auto drawn = points({.sampler = "sobol", .dim = dim, .count = 32});
  for (const std::uint64_t i : {1ULL, 2ULL, 17ULL, 31ULL}) {
    const auto expected = boost_point(dim, i);
    for (std::size_t j = 0; j < dim; ++j) REQUIRE(drawn[i * dim + j] == fraction52(expected[j]));
  }
}

TEST_CASE(
    "every state word of every conversion gives a coordinate in range: all 2^23 in fp32, the "
    "extremes in fp64",
    "[device]") {
  // The conversions of prelude.cl and lattice.cl on chosen words, through a kernel of this test.
  const std::string body = R"(
__kernel void convert(__global const word *words, __global const word *zeros, __global scalar *out) {
  const size_t i = get_global_id(0);
  out[2 * i] = unit_from_word(words[i]);
  points p; p.dim = 0; p.j = 0; p.lanes = zeros; p.state[0] = words[i];
  out[2 * i + 1] = points_next(&p);
})";
  for (const bool fp64 : {false, true}) {
    for (const bool centred : {false, true}) {
      std::string text = fmt::format(
          "#define KOKSMA_LANES_PER_ITEM 1\n#define KOKSMA_DIM 1\n#define KOKSMA_FP64 {:d}\n"
          "#define KOKSMA_CENTRED {:d}\n",
          fp64, centred);
      text += std::string(embedded_text("kernels/prelude.cl")) +
              std::string(embedded_text("kernels/points/lattice.cl")) + body;
      std::vector<std::uint64_t> words;
      if (fp64) {
        for (const std::uint64_t top :
             {0ULL, 1ULL, 2ULL, (1ULL << 51) - 1, 1ULL << 51, (1ULL << 52) - 2, (1ULL << 52) - 1})
          for (const std::uint64_t low : {0ULL, 1ULL, 0xFFFULL})
            words.push_back(top << 12 | low), words.push_back(low << 52 | top);
      } else {
        for (std::uint64_t k = 0; k < 1ULL << 23; ++k) words.push_back(k << 9);
        words.push_back(0xFFFFFFFFU);
      }
      std::vector<std::uint32_t> narrow(words.begin(), words.end());
      Device& device = test::device();
      const cl::Buffer in = fp64 ? device.upload(words.data(), words.size() * 8)
                                 : device.upload(narrow.data(), narrow.size() * 4);
      const cl::Buffer out = device.allocate(words.size() * 2 * (fp64 ? 8 : 4));
      cl::Kernel kernel(device.build({"conversions", text, "-cl-std=CL1.2 -w"}).program, "convert");
      const std::uint64_t none[2] = {0, 0};
      const cl::Buffer zeros = device.upload(none, sizeof(none));
      kernel.setArg(0, in);
      kernel.setArg(1, zeros);
      kernel.setArg(2, out);
      device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(words.size()),
                                          cl::NDRange(1));
      std::vector<double> wide(fp64 ? words.size() * 2 : 0);
      std::vector<float> single(fp64 ? 0 : words.size() * 2);
      if (fp64) device.queue().enqueueReadBuffer(out, CL_TRUE, 0, wide.size() * 8, wide.data());
      if (!fp64)
        device.queue().enqueueReadBuffer(out, CL_TRUE, 0, single.size() * 4, single.data());
      const auto values = fp64 ? wide : std::vector<double>(single.begin(), single.end());
      // The all-ones word is for unit_from_word only: a lattice state never has low bits set in
      // fp32.
      const std::size_t last = fp64 ? values.size() : values.size() - 1;
      const auto [low, high] =
          std::minmax_element(values.begin(), values.begin() + static_cast<long>(last));
      const double unit = std::ldexp(1.0, fp64 ? -52 : -23);
      INFO("fp64 " << fp64 << " centred " << centred);
      CHECK(*low == (centred ? unit / 2 : 0.0));
      CHECK(*high == 1 - (centred ? unit / 2 : unit));
      if (!fp64) {
        for (std::size_t k = 0; k < 1U << 23; ++k)
          if (values[2 * k] != (static_cast<double>(k) + (centred ? 0.5 : 0)) * unit)
            FAIL("word " << k << " is not its own coordinate");
      }
    }
  }
}

TEST_CASE(
    "random equals Random123 bit for bit, in the documented order, at any index and replicate",
    "[device]") {
  // Word j of a point: two output words of one block or of two (kernels/README.md, "Random
  // streams").
  const std::uint64_t seed = 0x123456789ABCDEF0;
  const auto word = [&](std::uint64_t index, std::uint32_t r, std::uint32_t j, std::uint32_t dim) {
    const auto block = [&](std::uint32_t number) {
      const r123::Philox4x32::ctr_type counter{
          {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), r, number}};
      return r123::Philox4x32{}(
          counter, {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
    };
    const std::uint32_t k = j / 4;
    const bool one_block = dim - 4 * k <= 2;
    const std::uint32_t high = block(2 * k)[j % 4],
                        low = one_block ? block(2 * k)[j % 4 + 2] : block(2 * k + 1)[j % 4];
    return std::uint64_t{high} << 32 | low;
  };
  for (const std::uint32_t dim : {1U, 2U, 11U, 21U}) {
    for (const std::uint64_t start : {0ULL, (1ULL << 32) - 8, (1ULL << 40) + 3}) {
      for (const std::uint32_t r : {0U, 7U}) {
        const auto drawn = points({.sampler = "random",
                                   .dim = dim,
                                   .start = start,
                                   .count = 24,
                                   .replicate = r,
                                   .seed = seed});
        for (std::uint64_t i = 0; i < 24; ++i) {
          for (std::uint32_t j = 0; j < dim; ++j) {
            INFO("index " << start + i << " dimension " << j << " of " << dim);
            REQUIRE(drawn[i * dim + j] ==
                    fraction52(word(start + i, r, j, dim)) + std::ldexp(1.0, -53));
          }
        }
      }
    }
  }
}

TEST_CASE("antithetic points come in pairs x and 1 - x, each pair new", "[device]") {
  std::size_t samplers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::has_property(s, "antithetic-pairs")) continue;
    ++samplers;
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      for (const std::uint32_t lanes : {1U, 4U, 16U}) {
        for (const std::uint64_t start : {0ULL, (1ULL << 33) - 8}) {
          const auto drawn = points({.sampler = s.name,
                                     .dim = 5,
                                     .precision = precision,
                                     .start = start,
                                     .count = 64,
                                     .lanes_per_item = lanes});
          std::set<double> firsts;
          for (std::size_t i = 0; i < 64; i += 2) {
            firsts.insert(drawn[5 * i]);
            for (std::size_t j = 0; j < 5; ++j)
              REQUIRE(drawn[5 * i + j] + drawn[5 * (i + 1) + j] == 1);
          }
          CHECK(firsts.size() == 32);
        }
      }
    }
  }
  CHECK(samplers > 0);
}

TEST_CASE("Random123's published known answers of Philox4x32-10 hold for the host's draws",
          "[unit]") {
  // kat_vectors of Random123 1.14: counters and keys all zero and all ones.
  const RandomPair zero = random_pair(0, 0, 0, RandomPurpose::points, 0);
  CHECK(zero.first == 0x6627e8d5e169c58dU);
  CHECK(zero.second == 0xbc57ac4c9b00dbd8U);
}

TEST_CASE("draws for different purposes, replicates, dimensions and indices are different",
          "[unit]") {
  std::set<std::uint64_t> seen;
  std::size_t drawn = 0;
  for (const auto purpose :
       {RandomPurpose::points, RandomPurpose::digital_shift, RandomPurpose::linear_scramble,
        RandomPurpose::nested_scramble, RandomPurpose::lattice_shift})
    for (std::uint32_t r = 0; r < 4; ++r)
      for (std::uint32_t d = 0; d < 4; ++d)
        for (std::uint64_t i = 0; i < 4; ++i, ++drawn)
          seen.insert(random_pair(1, i, r, purpose, d).first);
  CHECK(seen.size() == drawn);
}

TEST_CASE("a lattice's first 2^k points are the multiples of one point, in Gray order",
          "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::has_property(s, "rank-1-lattice")) continue;
    // 9 and 20 dimensions: the two ways to keep the state.
    for (const std::uint32_t dim : {9U, 20U}) {
      const auto drawn = points({.sampler = s.name, .dim = dim, .count = 1 << 12, .log2_block = 9});
      // Point 2^12 - 1 is that of Gray code 2^11, whose radical inverse is 2^-12: the generating
      // vector.
      std::vector<std::uint64_t> z;
      for (std::uint32_t j = 0; j < dim; ++j) {
        const double step = drawn[4095 * dim + j] - drawn[j];
        z.push_back(
            static_cast<std::uint64_t>(std::llround(std::ldexp(step - std::floor(step), 12))));
      }
      if (s.options["vector"] != "drawn") {
        const Json vector =
            parse_json(embedded_text("kernels/points/vectors/" +
                                     s.options["vector"].get<std::string>() + ".json"),
                       "test");
        for (std::uint32_t j = 0; j < dim; ++j)
          REQUIRE(z[j] == vector["z"][j].get<std::uint64_t>() % 4096);
      }
      for (std::uint64_t i = 0; i < 1 << 12; ++i) {
        const std::uint64_t gray = i ^ i >> 1;
        std::uint64_t reversed = 0;
        for (unsigned k = 0; k < 12; ++k) reversed |= (gray >> k & 1) << (11 - k);
        for (std::uint32_t j = 0; j < dim; ++j) {
          const double multiple = std::ldexp(static_cast<double>(reversed * z[j] % 4096), -12);
          const double shift = s.centred ? drawn[j] : 0.0;  // point 0 is the shift
          const double expected = multiple + shift - (multiple + shift >= 1 ? 1 : 0);
          INFO(s.name << " point " << i << " dimension " << j);
          REQUIRE(drawn[i * dim + j] == Approx(expected).margin(1e-15));
        }
      }
    }
  }
}

TEST_CASE("a direction-number file gives the built-in sequence, and says where it is wrong",
          "[unit]") {
  const test::TemporaryFolder folder;
  // The head of Joe and Kuo's new-joe-kuo-6.21201.
  const std::string good =
      "d s a m_i\n2 1 0 1\n3 2 1 1 3\n4 3 1 1 3 1\n5 3 2 1 1 1\n6 4 1 1 1 3 3\n7 4 4 1 3 5 13\n";
  const auto from_file = sobol_matrices_from_file(folder.write("good", good), 7, 52);
  CHECK(from_file.words == sobol_matrices(7, 52).words);
  CHECK_THROWS_WITH(
      sobol_matrices_from_file(folder.path("good"), 8, 52),
      Catch::Contains("direction numbers for 7 dimensions") && Catch::Contains("8 are drawn"));
  CHECK_THROWS_WITH(
      sobol_matrices_from_file(folder.write("even", "d s a m_i\n2 1 0 1\n3 2 1 1 2\n"), 3, 10),
      Catch::Contains("even:3") && Catch::Contains("m_2"));
  CHECK_THROWS_WITH(
      sobol_matrices_from_file(folder.write("gap", "d s a m_i\n2 1 0 1\n4 3 1 1 3 1\n"), 3, 10),
      Catch::Contains("gap:3") && Catch::Contains("dimension 3 comes here"));
  CHECK_THROWS_WITH(sobol_matrices_from_file(folder.path("none"), 3, 10),
                    Catch::Contains("cannot be read"));
}

TEST_CASE("generating matrices are upper triangular with a unit diagonal in all 52 columns",
          "[unit]") {
  const auto m = sobol_matrices(100, 52);
  for (std::uint32_t k = 0; k < m.columns; ++k)
    for (std::uint32_t d = 0; d < m.dim; ++d)
      REQUIRE(std::countr_zero(m.words[std::size_t{k} * m.dim + d]) == 63 - static_cast<int>(k));
}
