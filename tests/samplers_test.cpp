// What holds for every sampler of the catalog: nets stay nets under every scrambling, random access
// equals replay, coordinates stay in range, precisions and widths draw the same points.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using koksma::test::points;
using koksma::test::PointsSpec;

namespace {

bool is_net(const Sampler& s) { return test::has_property(s, "digital-net"); }

// Every elementary interval of area 2^-m in base 2 holds exactly one of the first 2^m points (t =
// 0).
bool is_0m2_net(const std::vector<double>& xy, unsigned m) {
  for (unsigned q = 0; q <= m; ++q) {
    std::set<std::pair<std::uint64_t, std::uint64_t>> boxes;
    for (std::size_t i = 0; i < xy.size() / 2; ++i)
      boxes.emplace(static_cast<std::uint64_t>(std::ldexp(xy[2 * i], static_cast<int>(q))),
                    static_cast<std::uint64_t>(std::ldexp(xy[2 * i + 1], static_cast<int>(m - q))));
    if (boxes.size() != xy.size() / 2) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("declared known answers hold", "[device]") {
  std::size_t answers = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s)) continue;
    for (const Json& known : s.known_answers) {
      const auto expected = known["points"].get<std::vector<std::vector<double>>>();
      const std::uint32_t dim = known["dim"];
      const auto drawn = points(
          {.sampler = s.name, .dim = dim, .start = known["start"], .count = expected.size()});
      for (std::size_t i = 0; i < expected.size(); ++i)
        for (std::size_t j = 0; j < dim; ++j) REQUIRE(drawn[i * dim + j] == expected[i][j]);
      ++answers;
    }
  }
  REQUIRE(answers > 0);
}

TEST_CASE(
    "every base-2 net keeps all elementary intervals of a (0,m,2)-net, whatever its randomization",
    "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!is_net(s) || !test::complete(s)) continue;
    for (const Precision precision : test::precisions(s)) {
      for (const std::uint32_t r : test::some_replicates(s)) {
        for (const unsigned m : {1U, 2U, 4U, 7U, 10U}) {
          INFO(s.name << " " << precision_name(precision) << " replicate " << r << " m " << m);
          const std::uint64_t n = std::uint64_t{1} << m;
          REQUIRE(is_0m2_net(points({.sampler = s.name,
                                     .dim = 2,
                                     .precision = precision,
                                     .count = n,
                                     .replicate = r,
                                     .n = n}),
                             m));
        }
      }
    }
  }
}

TEST_CASE("replicates of a randomized sampler differ, and so do seeds", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!s.replicable || !test::complete(s)) continue;
    INFO(s.name);
    const std::uint32_t dim = test::usual_dim(s);
    const auto first = points({.sampler = s.name, .dim = dim, .count = 16});
    CHECK(first != points({.sampler = s.name, .dim = dim, .count = 16, .replicate = 1}));
    CHECK(first != points({.sampler = s.name, .dim = dim, .count = 16, .seed = 2}));
  }
}

TEST_CASE("random access equals replay from the start", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s)) continue;
    const std::uint32_t dim = test::usual_dim(s);
    const std::uint64_t n = test::admitted_size(s, dim, 4096);
    for (const Precision precision : test::precisions(s)) {
      INFO(s.name << " " << precision_name(precision));
      const auto replayed = points({.sampler = s.name,
                                    .dim = dim,
                                    .precision = precision,
                                    .count = 4096,
                                    .log2_block = 12,
                                    .n = n});
      const auto accessed = points({.sampler = s.name,
                                    .dim = dim,
                                    .precision = precision,
                                    .count = 4096,
                                    .log2_block = 4,
                                    .n = n});
      REQUIRE(replayed == accessed);
      const auto part = points({.sampler = s.name,
                                .dim = dim,
                                .precision = precision,
                                .start = 1234,
                                .count = 2862,
                                .n = n});
      REQUIRE(std::equal(part.begin(), part.end(), replayed.begin() + 1234L * dim));
    }
  }
}

TEST_CASE("random access equals replay around index 2^32, for sets that reach it", "[device]") {
  std::size_t reaching = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (s.max_log2_n <= 33 || !test::complete(s)) continue;
    ++reaching;
    INFO(s.name);
    const std::uint32_t dim = test::usual_dim(s);
    const std::uint64_t start = (1ULL << 32) - 4096, n = test::admitted_size(s, dim, start + 8192);
    const auto replayed = points(
        {.sampler = s.name, .dim = dim, .start = start, .count = 8192, .log2_block = 12, .n = n});
    REQUIRE(replayed == points({.sampler = s.name,
                                .dim = dim,
                                .start = start,
                                .count = 8192,
                                .log2_block = 4,
                                .n = n}));
    const auto wrapped = points({.sampler = s.name, .dim = dim, .count = 4096, .n = n});
    REQUIRE_FALSE(std::equal(wrapped.begin(), wrapped.end(), replayed.begin() + 4096L * dim));
  }
  CHECK(reaching > 5);
}

TEST_CASE(
    "the first points of a larger set are the smaller set where the entry says so, and only there",
    "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s)) continue;
    const std::uint32_t dim = test::usual_dim(s);
    const std::uint64_t small = test::admitted_size(s, dim, 200),
                        large = test::admitted_size(s, dim, 16 * small);
    const auto few = points({.sampler = s.name, .dim = dim, .count = small, .n = small});
    const auto many = points({.sampler = s.name, .dim = dim, .count = large, .n = large});
    INFO(s.name << " " << small << " and " << large);
    CHECK(std::equal(few.begin(), few.end(), many.begin()) == s.extensible);
  }
}

TEST_CASE("fp32 draws the points of fp64 at 23 bits", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s) || s.precisions.size() < 2) continue;
    const std::uint32_t dim = test::usual_dim(s);
    const std::uint64_t n = test::grid_size(s, dim);
    const std::uint64_t count = std::min<std::uint64_t>(n, 1024);
    const auto fine = points({.sampler = s.name, .dim = dim, .count = count, .n = n});
    const auto coarse = points(
        {.sampler = s.name, .dim = dim, .precision = Precision::fp32, .count = count, .n = n});
    for (std::size_t i = 0; i < fine.size(); ++i) {
      INFO(s.name << " value " << i);
      REQUIRE(std::floor(std::ldexp(fine[i], 23)) == std::floor(std::ldexp(coarse[i], 23)));
    }
  }
}

TEST_CASE("coordinates are the same bits for 1, 4, 8 and 16 lanes per work-item", "[device]") {
  // Sums at every width in both precisions are compared in pieces_test.cpp.
  for (const Sampler& s : test::samplers_by_kernel()) {
    const std::uint32_t dim = test::usual_dim(s);
    const auto wide = points({.sampler = s.name, .dim = dim, .count = 512});
    for (const std::uint32_t lanes : {1U, 4U, 8U}) {
      INFO(s.name << " lanes " << lanes);
      REQUIRE(wide ==
              points({.sampler = s.name, .dim = dim, .count = 512, .lanes_per_item = lanes}));
    }
  }
}

TEST_CASE("the last points of the largest set lie in the declared range and on the declared grid",
          "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s) || !s.extensible) continue;
    const std::uint32_t dim = test::usual_dim(s);
    for (const Precision precision : test::precisions(s)) {
      const unsigned bits = precision == Precision::fp32 ? 23 : 52;
      // Deterministic points are refused where the precision can not tell them apart.
      const unsigned log2_n = s.centred ? s.max_log2_n : std::min(s.max_log2_n, bits);
      const std::uint64_t end = std::uint64_t{1} << log2_n;
      const std::uint64_t count = std::min<std::uint64_t>(end, 1 << 12);
      for (const double x : points({.sampler = s.name,
                            .dim = dim,
                            .precision = precision,
                            .start = end - count,
                            .count = count})) {
        const double units = std::ldexp(x, static_cast<int>(bits)) - (s.centred ? 0.5 : 0.0);
        INFO(s.name << " " << precision_name(precision) << " x = " << x);
        REQUIRE((x < 1 && (s.centred ? x > 0 : x >= 0)));
        REQUIRE((bits == 52 || units == std::floor(units)));
      }
    }
  }
}

TEST_CASE("coordinates lie in the declared range and on the declared grid", "[device]") {
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s)) continue;
    const std::uint32_t dim = test::usual_dim(s);
    for (const Precision precision : test::precisions(s)) {
      const int bits = precision == Precision::fp32 ? 23 : 52;
      const std::uint64_t n = test::grid_size(s, dim);
      for (const double x :
           points({.sampler = s.name, .dim = dim, .precision = precision, .count = n, .n = n})) {
        const double units = std::ldexp(x, bits) - (s.centred ? 0.5 : 0.0);
        INFO(s.name << " x = " << x);
        REQUIRE((x < 1 && (s.centred ? x > 0 : x >= 0)));
        REQUIRE((bits == 52 || units == std::floor(units)));
      }
    }
  }
}

TEST_CASE("tables too large for their replicates are refused before they are built", "[device]") {
  DeviceFacts small = test::device().facts();
  small.max_allocation = 1 << 20;
  std::size_t refused = 0;
  for (const Sampler& s : test::catalog().samplers) {
    if (!s.replicable || !test::complete(s) || find_table_builder(s.family) == nullptr) continue;
    const std::uint32_t dim = test::usual_dim(s), most = 65536;
    const Plan plan = make_points_plan(test::catalog(), s.name, dim, Precision::fp64,
                                       test::admitted_size(s, dim, 1024), most, 1, small);
    // 65536 replicates of one word are half a MiB: which tables they fit is told at once.
    if (plan.preparation) continue;
    const PointTable one = [&] {
      PointRequest request = plan.request;
      request.replicates = 2;
      return find_table_builder(s.family)(request);
    }();
    PointRequest single = plan.request;
    single.replicates = 1;
    const std::size_t each = one.words.size() - find_table_builder(s.family)(single).words.size();
    INFO(s.name << ": " << each << " words per replicate");
    if (each * most * 8 <= small.max_allocation) continue;
    ++refused;
    CHECK_THROWS_AS(build_point_table(plan), UnsupportedError);
  }
  CHECK(refused > 5);
}
