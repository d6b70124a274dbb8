// No sample hides behind those of the other lanes: counters look at vectors first.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "tests/counters_support.hpp"

using namespace koksma;
using namespace koksma::test;

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
  // 0 where x < 1/256, 1.25 + 2^-22 where it is in the next interval.
  const std::string broken = R"(static inline bits broken(real x) {
  const bits k = KOKSMA_TO_BITS(x * R(256.0));
  const bits first = (k - 1) >> (word)(8 * sizeof(word) - 1);
  const bits second = ((k - 2) >> (word)(8 * sizeof(word) - 1)) ^ first;
  return (KOKSMA_AS_BITS(x) & (first - (word)1) & (second - (word)1)) |
      (KOKSMA_AS_BITS((real)R(0x1.400004p0)) & ((word)0 - second));
}
)";
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
      CHECK(outside.coord_le0 == replicates);
      CHECK(outside.coord_ge1 == replicates);
    }
}
