// Launch shapes: which of the timed ones a plan takes, that results stay the same bits, and that a
// tuning file can be lost, damaged or another device's without harm.
#include "plan/tuning.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <set>

#include "device/tuner.hpp"
#include "device/tuning_file.hpp"
#include "error/error.hpp"
#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;

TimedShape timed(const std::string& family, std::uint32_t lanes, double seconds,
                 std::uint32_t local = 1, std::uint64_t items = kItemsPerLaunch,
                 Precision precision = Precision::fp64) {
  return {family, precision, {lanes, local, std::nullopt, items}, seconds};
}

DeviceFacts device_with(const std::vector<TimedShape>& shapes, bool is_cpu = true) {
  DeviceFacts facts;
  facts.is_cpu = is_cpu;
  facts.max_work_group_size = 256;
  facts.tuning = std::make_shared<const Tuning>(Tuning{"2026-01-01T00:00:00Z", shapes});
  return facts;
}

// What a cell of this integrand would get.
ShapeChoice choice(const DeviceFacts& facts, const std::string& integrand,
                   const std::string& sampler, std::uint32_t dim = 2, std::uint32_t least = 1) {
  const Sampler s = test::catalog().sampler(sampler, "test");
  return choose_shape(
      facts, {&s, &test::catalog().integrand(integrand, "test"), dim, Precision::fp64, least});
}

const Integrand& integrand_with(bool exact_operations) {
  for (const Integrand& f : test::catalog().integrands)
    if (f.exact_operations == exact_operations && f.min_dim <= 2 && f.max_dim >= 2 &&
        !f.all_coordinates)
      return f;
  throw std::runtime_error("no such integrand");
}

}  // namespace

TEST_CASE("a plan takes the fastest timed shape, and the default where less than 5 % is gained",
          "[unit]") {
  const std::string f = integrand_with(true).name;
  const ShapeChoice faster = choice(
      device_with({timed("random", 16, 1.0), timed("random", 8, 0.8), timed("random", 4, 0.9)}), f,
      "random");
  CHECK(faster.tuned);
  CHECK(faster.shape.lanes_per_item == 8);
  const ShapeChoice noise =
      choice(device_with({timed("random", 16, 1.0), timed("random", 8, 0.96)}), f, "random");
  CHECK_FALSE(noise.tuned);
  CHECK(noise.shape.lanes_per_item == 16);
  // A launch bound is part of the shape, and 2^13 is what a default shape has.
  const ShapeChoice bound = choice(
      device_with({timed("random", 16, 1.0), timed("random", 16, 0.8, 1, 2048)}), f, "random");
  CHECK(bound.tuned);
  CHECK(bound.shape.items_per_launch == 2048U);
}

TEST_CASE("a tuning without the default shape, or of the other precision, chooses nothing",
          "[unit]") {
  const std::string f = integrand_with(true).name;
  CHECK_FALSE(choice(device_with({timed("random", 8, 0.1)}), f, "random").tuned);
  CHECK_FALSE(choice(device_with({timed("random", 16, 1.0, 1, kItemsPerLaunch, Precision::fp32),
                                  timed("random", 8, 0.1, 1, kItemsPerLaunch, Precision::fp32)}),
                     f, "random")
                  .tuned);
}

TEST_CASE("a family that was not timed takes the geometric mean over those that were", "[unit]") {
  const std::string f = integrand_with(true).name;
  const std::vector<TimedShape> shapes{timed("random", 16, 1.0),  timed("random", 8, 0.5),
                                       timed("random", 4, 1.0),   timed("digital", 16, 10.0),
                                       timed("digital", 8, 16.0), timed("digital", 4, 6.0)};
  CHECK(choice(device_with(shapes), f, "random").shape.lanes_per_item == 8);
  CHECK(choice(device_with(shapes), f, "sobol").shape.lanes_per_item == 4);
  CHECK(choice(device_with(shapes), f, "lattice").shape.lanes_per_item == 4);  // 1.25, 0.77
  // 3 and 1 / 2.5 times as fast is less in the geometric mean than twice 1.2, in the other mean
  // more.
  const auto uneven = device_with({timed("random", 16, 1.0), timed("digital", 16, 1.0),
                                   timed("random", 8, 1 / 3.0), timed("digital", 8, 2.5),
                                   timed("random", 4, 1 / 1.2), timed("digital", 4, 1 / 1.2)});
  CHECK(choice(uneven, f, "lattice").shape.lanes_per_item == 4);
  // A shape that one family alone was timed with does not stand beside those of all.
  const auto partly =
      device_with({timed("random", 16, 1.0), timed("digital", 16, 1.0), timed("random", 8, 0.1),
                   timed("random", 4, 0.8), timed("digital", 4, 0.8)});
  CHECK(choice(partly, f, "lattice").shape.lanes_per_item == 4);
}

TEST_CASE("width 1 and the others are exchanged only for integrands of exact operations",
          "[unit]") {
  const std::vector<TimedShape> on_cpu{timed("random", 16, 1.0), timed("random", 1, 0.1)};
  CHECK(choice(device_with(on_cpu), integrand_with(true).name, "random").tuned);
  CHECK_FALSE(choice(device_with(on_cpu), integrand_with(false).name, "random").tuned);
  const std::vector<TimedShape> on_gpu{timed("random", 1, 1.0, 64), timed("random", 4, 0.5, 64),
                                       timed("random", 1, 0.8, 128)};
  const ShapeChoice any = choice(device_with(on_gpu, false), integrand_with(true).name, "random");
  CHECK(any.shape.lanes_per_item == 4);
  const ShapeChoice same = choice(device_with(on_gpu, false), integrand_with(false).name, "random");
  CHECK(same.shape.lanes_per_item == 1);
  CHECK(same.shape.local_size == 128);
}

TEST_CASE(
    "a tuned shape stays within private memory, the device's groups and the estimator's lanes",
    "[unit]") {
  const std::string f = integrand_with(true).name;
  const std::vector<TimedShape> shapes{timed("digital", 1, 1.0, 64), timed("digital", 4, 0.5, 512),
                                       timed("digital", 4, 0.7, 32)};
  CHECK(choice(device_with(shapes, false), f, "sobol").shape.local_size == 32);
  // 4 lanes x 32 items x 1111 dimensions x 8 bytes are more than 1 MiB.
  CHECK_FALSE(choice(device_with(shapes, false), f, "sobol", 1111).tuned);
  const std::vector<TimedShape> narrow{timed("random", 16, 1.0), timed("random", 4, 0.5)};
  CHECK_FALSE(choice(device_with(narrow), f, "random", 2, 8).tuned);
}

TEST_CASE("a tuning is read as it was written, and forgotten with its file", "[unit]") {
  const test::TemporaryFolder folder;
  const test::CacheAt cache(folder.path("cache"));
  DeviceFacts facts;
  facts.name = "a device";
  facts.driver = "1.0";
  CHECK(read_tuning(facts) == nullptr);
  Tuning tuning{"2026-01-01T00:00:00Z",
                {timed("random", 16, 1.25e-3), timed("digital", 4, 0.1, 64, 2048)}};
  REQUIRE(write_tuning(facts, tuning));
  const auto back = read_tuning(facts);
  REQUIRE(back != nullptr);
  CHECK(back->date == tuning.date);
  REQUIRE(back->timed.size() == 2);
  CHECK(back->timed[1].family == "digital");
  CHECK(back->timed[1].shape.lanes_per_item == 4);
  CHECK(back->timed[1].shape.local_size == 64);
  CHECK(back->timed[1].shape.items_per_launch == 2048U);
  CHECK(back->timed[0].seconds == 1.25e-3);
  fs::remove(tuning_file(facts));
  CHECK(read_tuning(facts) == nullptr);
}

TEST_CASE("a tuning that is damaged or stale is refused with the reason, and is no failure",
          "[unit]") {
  const test::TemporaryFolder folder;
  const test::CacheAt cache(folder.path("cache"));
  DeviceFacts facts;
  facts.name = "a device";
  facts.driver = "1.0";
  REQUIRE(write_tuning(facts, {"2026-01-01T00:00:00Z", {timed("random", 16, 1.0)}}));
  const std::string path = tuning_file(facts), whole = read_text_file(path);
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    std::string text = whole;
    REQUIRE(text.find(from) != std::string::npos);
    text.replace(text.find(from), from.size(), to);
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
    INFO(from << " -> " << to);
    CHECK_THROWS_WITH(read_tuning(facts), Contains(path) && Contains(why));
    CHECK(usable_tuning(facts) == nullptr);
  };
  refused("\"driver\": \"1.0\"", "\"driver\": \"1.1\"", "another device or driver");
  refused("\"compute_units\": 1", "\"compute_units\": 2", "another device or driver");
  refused("\"kernels\": \"", "\"kernels\": \"0123456789abcdef\", \"x\": \"", "x");
  const std::string kernels = whole.substr(whole.find("\"kernels\": \"") + 12, 16);
  refused(kernels, "0123456789abcdef", "other kernels");
  refused("\"lanes_per_item\": 16", "\"lanes_per_item\": 3", "lanes_per_item");
  refused("\"local_size\": 1,", "\"local_size\": 0,", "local_size");
  refused("\"seconds\": 1.0", "\"seconds\": -1.0", "seconds");
  refused("\"koksma_tuning\": 1", "\"koksma_tuning\": 2", "koksma_tuning");
  refused(whole.substr(whole.size() / 2), "", "malformed JSON");
  refused(whole, "", "malformed JSON");
  // Another driver has a file of its own.
  facts.driver = "2.0";
  CHECK(tuning_file(facts) != path);
  CHECK(read_tuning(facts) == nullptr);
}

TEST_CASE("tuning times the default shape and others of every family, and plans then use it",
          "[device][timing]") {
  Device device = Device::choose("");
  TuningWork work = tuning_work(device.facts());
  CHECK(work.kernels.size() >= 3);
  work.kernels.resize(1);
  work.n = 256;
  work.replicates = 4;
  work.lanes_per_item = {8, 16};
  work.items_per_launch = {2, kItemsPerLaunch};
  const Tuning tuning = tune(device, test::catalog(), work);
  std::set<std::uint32_t> lanes;
  for (const TimedShape& t : tuning.timed) {
    CHECK(t.seconds > 0);
    lanes.insert(t.shape.lanes_per_item);
  }
  CHECK(lanes == std::set<std::uint32_t>{8, 16});
  // Two widths and one launch bound more, in every precision.
  CHECK(tuning.timed.size() == (device.facts().fp64 ? 6U : 3U));
}

TEST_CASE("results are the same bits whatever was tuned", "[device]") {
  DeviceFacts tuned = test::device().facts();
  Tuning tuning{"2026-01-01T00:00:00Z", {}};
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    tuning.timed.push_back(timed("any", 16, 1.0, 1, kItemsPerLaunch, precision));
    tuning.timed.push_back(timed("any", 4, 0.5, 1, 48, precision));
  }
  tuned.tuning = std::make_shared<const Tuning>(tuning);
  for (const char* sampler : {"random", "sobol-owen"}) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      Cell cell = test::cell("genz-gaussian:d=2", sampler, 1 << 14, 4);
      cell.precision = precision;
      INFO(sampler << " " << precision_name(precision));
      const auto row = [&](const DeviceFacts& facts) {
        Plan plan = make_plan(test::catalog(), cell, facts);
        CHECK(plan.shape_is_tuned == (facts.tuning != nullptr));
        PreparedCell prepared(test::catalog(), test::device(), test::device(), std::move(plan));
        return prepared.run_row(cell.n.front());
      };
      DeviceFacts untuned = tuned;
      untuned.tuning = nullptr;
      const Row plain = row(untuned), shaped = row(tuned);
      CHECK(plain.estimate.value == shaped.estimate.value);
      CHECK(plain.errors.rmse == shaped.errors.rmse);
      CHECK(plain.log2_block == shaped.log2_block);
    }
  }
}

TEST_CASE("launches queued ahead hand out the same sums in the same order", "[device]") {
  const Cell cell = test::cell("genz-gaussian:d=2", "random", 1 << 14, 4);
  for (const std::uint64_t items : {std::uint64_t{3}, std::uint64_t{48}, kItemsPerLaunch}) {
    const Plan plan = make_plan(test::catalog(), cell, test::device().facts(), "",
                                {LaunchShape{16, 1, std::nullopt, items}});
    const ExactValues exact = compute_exact(test::device(), *plan.integrand, cell.scene);
    Integrator integrator(test::device(), plan, exact.coefficients);
    const auto sums = [&](bool ahead) {
      integrator.queue_ahead(ahead);
      std::vector<double> all;
      integrator.run(cell.n.front(), 0,
                     [&](std::uint32_t word, std::uint32_t r, std::span<const double> partials) {
                       all.push_back(word);
                       all.push_back(r);
                       all.insert(all.end(), partials.begin(), partials.end());
                     });
      return all;
    };
    CHECK(sums(true) == sums(false));
    // An error in between leaves nothing behind that the next run would meet.
    integrator.queue_ahead(true);
    CHECK_THROWS_AS(integrator.run(cell.n.front(), 0,
                                   [](std::uint32_t, std::uint32_t, std::span<const double>) {
                                     throw std::runtime_error("no");
                                   }),
                    std::runtime_error);
    CHECK(sums(true) == sums(false));
  }
}

TEST_CASE("a damaged tuning is told on stderr and a run goes on with the default shapes",
          "[device]") {
  const test::TemporaryFolder folder;
  const std::string environment = "KOKSMA_KEPT=on XDG_CACHE_HOME=" + folder.path("cache");
  const auto path = [&] {
    const test::CacheAt cache(folder.path("cache"));
    return tuning_file(test::device().facts());
  }();
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path) << "{";
  const std::string explain = "explain --scene linear-prod:d=2 --sampler random --n 256";
  const auto damaged = test::run_command(explain, environment);
  CHECK(damaged.status == 0);
  CHECK_THAT(damaged.output, Contains("a tuning is ignored") && Contains(path) &&
                                 Contains("shape       the device's default"));
  CHECK_THAT(test::run_command("tune --show", environment).output, Contains("ignored"));
  CHECK_THAT(test::run_command("tune --forget", environment).output, Contains("removed " + path));
  CHECK_FALSE(fs::exists(path));
  CHECK_THAT(test::run_command("tune --show", environment).output, Contains("has no tuning"));
  CHECK(test::run_command("tune --show --forget", environment).status == 2);

  {
    const test::CacheAt cache(folder.path("cache"));
    DeviceFacts facts = test::device().facts();
    write_tuning(facts,
                 {"2026-01-01T00:00:00Z", {timed("random", 16, 1.0), timed("random", 8, 0.5)}});
  }
  CHECK_THAT(test::run_command(explain, environment).output,
             Contains("tuned by koksma tune on 2026-01-01") && Contains("8 lanes per work-item"));
  CHECK_THAT(
      test::run_command(explain, "KOKSMA_KEPT=off XDG_CACHE_HOME=" + folder.path("cache")).output,
      Contains("the device's default"));
}
