// Preparations: point sets computed on the device are the same everywhere, and the cache on disk
// can be lost, damaged or forbidden without harm.
#include "device/prepare.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "catalog/json.hpp"
#include "plan/compose.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

// Every sampler whose set a device prepares, with 256 points.
std::vector<std::string> prepared_samplers() {
  std::vector<std::string> names;
  for (const Sampler& s : test::catalog().samplers) {
    if (std::none_of(s.parameters.begin(), s.parameters.end(),
                     [](const SamplerParameter& p) { return p.name == "points"; }))
      continue;
    const std::string name = s.name + ":points=256";
    if (make_points_plan(test::catalog(), name, 2, Precision::fp64, 256, 1, 1,
                         test::device().facts())
            .preparation)
      names.push_back(name);
  }
  return names;
}

Plan plan_prepared(const std::string& sampler, std::uint64_t seed = 1) {
  return make_points_plan(test::catalog(), sampler, 2, Precision::fp64, 256, 1, seed,
                          test::device().facts());
}

// The table through a device object that remembers nothing.
std::vector<std::byte> fresh_table(const Plan& plan) {
  test::device().prepared().clear();
  return point_table(test::device(), plan);
}

}  // namespace

TEST_CASE("best candidates are Mitchell's: the farthest of n + 1, by brute force", "[device]") {
  const test::TemporaryFolder folder;
  const test::CacheAt cache(folder.path("cache"));
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{0xFEDCBA9876543210U}}) {
    const auto candidate = [&](std::uint32_t n, std::uint32_t m) {
      return r123::Philox4x32{}(
          r123::Philox4x32::ctr_type{{m, n, 0, 10U << 24}},
          r123::Philox4x32::key_type{
              {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
    };
    const auto squared = [](std::uint32_t a, std::uint32_t b) {
      const std::uint64_t d = std::min(a - b, b - a);
      return d * d;
    };
    const Plan plan = plan_prepared("best-candidate:points=256", seed);
    fresh_table(plan);
    const std::vector<double>& set = *test::device().prepared().begin()->second;
    std::vector<std::array<std::uint32_t, 2>> expected;
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::array<std::uint32_t, 2> best{};
      std::uint64_t farthest = 0;
      for (std::uint32_t m = 0; m <= n; ++m) {
        const auto words = candidate(n, m);
        std::uint64_t nearest = ~std::uint64_t{0} >> 1;
        for (const auto& p : expected)
          nearest = std::min(nearest, squared(words[0], p[0]) + squared(words[1], p[1]));
        if (nearest <= farthest) continue;
        farthest = nearest;
        best = {words[0], words[1]};
      }
      expected.push_back(best);
      REQUIRE(set[std::size_t{2} * n] == std::ldexp(best[0], -32));
      REQUIRE(set[std::size_t{2} * n + 1] == std::ldexp(best[1], -32));
    }
  }
}

TEST_CASE("a prepared set is the same for every work-group size, and another for every seed",
          "[device]") {
  const test::TemporaryFolder folder;
  const test::CacheAt cache(folder.path("cache"));
  for (const std::string& name : prepared_samplers()) {
    INFO(name);
    Plan plan = plan_prepared(name);
    const auto table = fresh_table(plan);
    CHECK(table != fresh_table(plan_prepared(name, 2)));
    fs::remove_all(folder.path("cache"));
    PlannedPreparation& preparation = *plan.preparation;
    preparation.local_size = 16;
    preparation.program = compose_preparation(test::catalog().family(plan.sampler->family),
                                              preparation.work.piece, 16);
    CHECK(table == fresh_table(plan));
  }
}

TEST_CASE("a set is taken from the cache, and a cached file that is not as written is replaced",
          "[device]") {
  const test::TemporaryFolder folder;
  const test::CacheAt cache(folder.path("cache"));
  const auto samplers = prepared_samplers();
  REQUIRE(samplers.size() >= 2);
  for (const std::string& name : samplers) {
    const Plan plan = plan_prepared(name);
    const std::string path = cache_file(*plan.preparation);
    INFO(path);
    REQUIRE(path.starts_with(folder.path("cache/koksma/")));
    const auto table = fresh_table(plan);
    const std::string whole = read_text_file(path);
    const auto written = fs::last_write_time(path) - std::chrono::hours(1);
    fs::last_write_time(path, written);
    CHECK(table == fresh_table(plan));
    CHECK(fs::last_write_time(path) == written);  // read, not written anew

    std::string flipped = whole, renamed = whole;
    flipped[whole.size() - 100] ^= 1;
    renamed[renamed.find("\"points\":256") + 9] = '3';
    for (const std::string& damaged :
         {flipped, renamed, whole.substr(0, whole.size() - 1), whole + "x", whole.substr(0, 20),
          std::string("not ours\n"), std::string()}) {
      std::ofstream(path, std::ios::binary | std::ios::trunc) << damaged;
      CHECK(table == fresh_table(plan));
      CHECK(read_text_file(path) == whole);
    }
  }
  // Nothing else is left behind.
  const auto files = std::distance(fs::directory_iterator(folder.path("cache/koksma")), {});
  CHECK(files == static_cast<std::ptrdiff_t>(samplers.size()));
}

TEST_CASE("a cache folder that cannot be written, or none at all, is no failure", "[device]") {
  const test::TemporaryFolder folder;
  const std::string name = prepared_samplers().front();
  const test::CacheAt cache(folder.path("cache"));
  const auto table = fresh_table(plan_prepared(name));
  folder.write("file", "");
  for (const std::string& bad :
       {folder.path("file"), std::string("/proc/nowhere"), std::string("relative")}) {
    const test::CacheAt forbidden(bad);
    const char* home = std::getenv("HOME");
    const std::string kept = home == nullptr ? "" : home;
    unsetenv("HOME");
    INFO(bad);
    CHECK(table == fresh_table(plan_prepared(name)));
    if (bad == "relative") CHECK(cache_folder().empty());
    if (home != nullptr) setenv("HOME", kept.c_str(), 1);
  }
  CHECK_FALSE(fs::exists("relative"));
}

TEST_CASE("a preparation that falls short says so and is not kept", "[device]") {
  const test::TemporaryFolder folder;
  const test::CacheAt cache(folder.path("cache"));
  for (const std::string& name : prepared_samplers()) {
    Plan plan = plan_prepared(name);
    // All but the last two launches that add points.
    auto& launches = plan.preparation->work.launches;
    const PreparationLaunch last = launches.back();
    launches.resize(launches.size() / 4);
    if (last.items > 1) launches.push_back(last);
    CHECK_THROWS_WITH(fresh_table(plan), Contains("of 256"));
    CHECK_FALSE(fs::exists(cache_file(*plan.preparation)));
  }
  test::device().prepared().clear();
}

TEST_CASE("explain shows the preparation, its kernels and where its set is kept", "[device]") {
  const test::TemporaryFolder folder;
  const auto result = test::run_command(
      "explain --scene linear-prod:d=2 --sampler best-candidate:points=256 --n 256",
      "XDG_CACHE_HOME=" + folder.path("cache") + " POCL_CACHE_DIR=" + folder.path("pocl"));
  CHECK(result.status == 0);
  CHECK_THAT(result.output, Contains("preparation") && Contains("256 points of 2 dimensions") &&
                                Contains(folder.path("cache/koksma/")) &&
                                Contains("kernels/points/prepare/candidates.cl"));
}
