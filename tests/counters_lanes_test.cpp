// No sample hides behind those of the other lanes: counters look at vectors first.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <string>
#include <utility>

#include "tests/counters_support.hpp"

using namespace koksma;
using namespace koksma::test;

namespace {

// Code of `bits broken(real x)`: x, but for the first six intervals of 1/256, whose points are
// outside (0,1) in either precision, three on either side.
std::string broken_points() {
  const std::pair<std::uint64_t, std::uint64_t> outside[] = {
      {0, 0},                             // 0
      {0x8000000000000000, 0x80000000},   // -0
      {0xBFF4000040000000, 0xBFA00002},   // -1.25 - 2^-22
      {0x3FF0000000000000, 0x3F800000},   // 1
      {0x3FF4000040000000, 0x3FA00002},   // 1.25 + 2^-22
      {0x7FF8000040000000, 0x7FC00001}};  // NaN
  std::string code =
      "static inline bits broken(real x) {\n"
      "  const bits k = KOKSMA_TO_BITS(x * R(256.0));\n"
      "  bits y = KOKSMA_AS_BITS(x), other;\n";
  for (std::size_t i = 0; i < std::size(outside); ++i)
    code += fmt::format(
        "  other = (k - (word){0}) | ((word){0} - k);\n"  // the top bit where k is not i
        "  y ^= (y ^ (word)(KOKSMA_FP64 ? {1}UL : {2}UL)) &\n"
        "       ((other >> (word)(8 * sizeof(word) - 1)) - (word)1);\n",
        i, outside[i].first, outside[i].second);
  return code + "  return y;\n}\n";
}

}  // namespace

// Shifted digitally, 256 points have one in every interval of 1/256, in whatever lane.
TEST_CASE("a sample that is counted is found among ordinary ones, in every lane", "[device]") {
  constexpr std::uint64_t n = 256;
  constexpr std::uint32_t replicates = 64;
  std::set<std::size_t> lanes_hit;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const auto x = test::points({.sampler = "sobol-shift", .dim = 1, .count = n, .replicate = r});
    lanes_hit.insert(static_cast<std::size_t>(std::min_element(x.begin(), x.end()) - x.begin()) %
                     16);
  }
  REQUIRE(lanes_hit.size() == 16);
  const std::string broken = broken_points();
  for (const Precision precision : test::kPrecisions)
    for (const std::uint32_t lanes : kWidths) {
      INFO(label(precision, lanes, n));
      const LaunchShape shape{lanes, 1, {}, {}};
      for (const int kind : {0, 1, 4, 6, 7, 9, 10, 12, 13, 14}) {
        const double value =
            value_of(patterns(precision)[static_cast<std::size_t>(kind)], precision);
        std::vector<double> values(n * replicates, 0x1.800004p0);
        std::fill_n(values.begin(), replicates, value);
        INFO("pattern " << kind);
        check_counts(
            count(own().plan(n, replicates, precision, shape, false,
                             fmt::format("my-lonely-pattern:kind={}", kind), true, "sobol-shift")),
            expected_of(values, precision));
      }
      const Counters outside =
          count(with_bad_coordinates(own().plan(n, replicates, precision, shape, false,
                                                "my-lonely-pattern:kind=11", true, "sobol-shift"),
                                     broken));
      CHECK(outside.coord_le0 == std::uint64_t{3} * replicates);
      CHECK(outside.coord_ge1 == std::uint64_t{3} * replicates);
    }
}
