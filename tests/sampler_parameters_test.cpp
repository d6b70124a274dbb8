// What may follow a sampler's name, and what the rotation does to the points.
#include <catch2/catch.hpp>
#include <cmath>

#include "catalog/sizes.hpp"
#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

bool rotates(const Sampler& s) {
  return !s.replicable && std::none_of(s.parameters.begin(), s.parameters.end(),
                                       [](const SamplerParameter& p) { return p.required; });
}

double wrapped(double x) { return x - std::floor(x); }

}  // namespace

TEST_CASE(
    "randomize=rotate shifts every point of a deterministic set by one uniform vector modulo 1",
    "[device]") {
  std::size_t rotated = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!rotates(s)) continue;
    ++rotated;
    const std::uint32_t dim = std::min(3U, s.max_dim);
    for (const std::string& name : s.precisions) {
      const Precision precision = name == "fp32" ? Precision::fp32 : Precision::fp64;
      const double unit = precision == Precision::fp32 ? 0x1p-23 : 0x1p-52;
      const auto plain = test::points(
          {.sampler = s.name, .dim = dim, .precision = precision, .start = 5, .count = 64});
      for (const std::uint32_t replicate : {0U, 3U}) {
        const auto drawn = test::points({.sampler = s.name + ":randomize=rotate",
                                         .dim = dim,
                                         .precision = precision,
                                         .start = 5,
                                         .count = 64,
                                         .replicate = replicate});
        for (std::size_t i = 0; i < drawn.size(); ++i) {
          const double shift = wrapped(drawn[i % dim] - plain[i % dim]);
          INFO(s.name << " " << name << " replicate " << replicate << " value " << i);
          REQUIRE((drawn[i] > 0 && drawn[i] < 1));
          // Differences of the grid's points are exact in double.
          REQUIRE(wrapped(drawn[i] - plain[i]) == shift);
          REQUIRE(wrapped(shift / unit) == 0.5);
        }
      }
    }
  }
  CHECK(rotated >= 3);
}

TEST_CASE("rotated points in fp32 are those of fp64 within one unit of 2^-23", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!rotates(s) || s.precisions.size() < 2) continue;
    const std::uint32_t dim = std::min(3U, s.max_dim);
    const std::uint64_t n = test::grid_size(s, dim);
    const std::string name = s.name + ":randomize=rotate";
    const auto fine = test::points({.sampler = name, .dim = dim, .count = n, .n = n});
    const auto coarse = test::points(
        {.sampler = name, .dim = dim, .precision = Precision::fp32, .count = n, .n = n});
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const double units =
          std::floor(std::ldexp(fine[i], 23)) - std::floor(std::ldexp(coarse[i], 23));
      INFO(s.name << " value " << i);
      // One unit below 0 is the largest coordinate.
      REQUIRE((units == 0 || units == 1 || units == 1 - 0x1p23));
    }
  }
}

TEST_CASE("a rotated lattice is the shifted lattice: the rotation adds nothing of its own",
          "[unit]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!rotates(s)) continue;
    const Sampler r = test::catalog().sampler(s.name + ":randomize=rotate", "test");
    INFO(s.name);
    CHECK(r.name == s.name + ":randomize=rotate");
    CHECK(r.rotated);
    CHECK(r.centred);
    CHECK(r.replicable);
    CHECK(r.default_estimator == "rqmc");
    CHECK(r.rate_class == s.rotated_rate_class);
    CHECK(fits(test::catalog().estimator("rqmc", "test"), r));
  }
}

TEST_CASE("the rotation is uniform and differs between replicates and dimensions",
          "[statistical]") {
  // Chi-squared on 16 cells of 4096 first points and the correlation of the first two dimensions: 6
  // standard deviations each, false alarm below 1e-7.
  const std::uint32_t replicates = 4096;
  const Plan plan = make_points_plan(test::catalog(), "sobol:randomize=rotate", 2, Precision::fp64,
                                     16, replicates, 1, test::device().facts());
  PointsDump dump(test::device(), plan);
  std::vector<double> cells(16, 0);
  double cross = 0;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const auto x = dump.read(0, 1, 16, r, 4);
    cells[static_cast<std::size_t>(x[0] * 16)] += 1;
    cross += (x[0] - 0.5) * (x[1] - 0.5) * 12;
  }
  double statistic = 0;
  for (const double count : cells) statistic += (count - 256) * (count - 256) / 256;
  CHECK(statistic < 15 + 6 * std::sqrt(30.0) + 12);
  CHECK(std::fabs(cross) < 6 * std::sqrt(4096.0));
}

TEST_CASE("wrong parameters of a sampler are told with what is allowed", "[unit]") {
  const Catalog& catalog = test::catalog();
  CHECK_THROWS_WITH(catalog.sampler("sobol:randomise=rotate", "--sampler"),
                    Contains("--sampler: unknown parameter of sampler 'sobol' 'randomise'") &&
                        Contains("did you mean 'randomize'?"));
  CHECK_THROWS_WITH(catalog.sampler("sobol:randomize=owen", "--sampler"),
                    Contains("randomize = 'owen'; allowed: rotate"));
  CHECK_THROWS_WITH(catalog.sampler("sobol:randomize", "x"),
                    Contains("'randomize' is no key=value"));
  CHECK_THROWS_WITH(catalog.sampler("sobol:", "x"), Contains("ends with ':'"));
  CHECK_THROWS_WITH(catalog.sampler("sobol:randomize=rotate,randomize=rotate", "x"),
                    Contains("is given twice") || Contains("takes no parameters"));
  CHECK_THROWS_WITH(catalog.sampler("sobol-owen:randomize=rotate", "x"),
                    Contains("sampler 'sobol-owen' with 'randomize'; it takes no parameters"));
  CHECK_THROWS_WITH(catalog.sampler("sobl:randomize=rotate", "x"),
                    Contains("did you mean 'sobol'?"));
}

TEST_CASE("the forms of N admit what they say and find the nearest", "[unit]") {
  Sampler s;
  s.max_log2_n = 20;
  const auto nearest = [&](const char* form, std::uint32_t d, std::uint64_t n) {
    s.size_form = form;
    const NearestSizes sizes = nearest_sizes(s, d, n);
    if (sizes.below) CHECK(admits(s, d, *sizes.below));
    if (sizes.above) CHECK(admits(s, d, *sizes.above));
    return std::pair(sizes.below.value_or(0), sizes.above.value_or(0));
  };
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  CHECK(nearest("any", 3, 997) == Pair(997, 997));
  CHECK(nearest("even", 3, 997) == Pair(996, 998));
  CHECK(nearest("power-of-two", 3, 1000) == Pair(512, 1024));
  CHECK(nearest("power-of-two", 3, 1024) == Pair(1024, 1024));
  CHECK(nearest("power-of-d", 2, 1000) == Pair(961, 1024));
  CHECK(nearest("power-of-d", 3, 1000) == Pair(1000, 1000));
  CHECK(nearest("power-of-d", 10, 1000) == Pair(1, 1024));
  CHECK(nearest("power-of-d", 21, 1000) == Pair(1, 0));
  CHECK(nearest("twice-power-of-d", 2, 1000) == Pair(968, 1058));
  CHECK(nearest("twice-power-of-d", 3, 2000) == Pair(2000, 2000));
  CHECK(nearest("rectangle", 2, 997) == Pair(992, 999));
  CHECK(nearest("rectangle", 2, 2) == Pair(2, 2));
  CHECK(nearest("rectangle", 2, 1 << 19) == Pair(1 << 19, 1 << 19));
  CHECK(nearest("rectangle", 2, 3) == Pair(2, 4));
}
