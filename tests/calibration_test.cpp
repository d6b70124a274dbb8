// Times of launches stand beside those of the calibration kernel.
#include "device/calibration.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "estimate/measure.hpp"
#include "estimate/timed_launches.hpp"
#include "tests/support.hpp"

using namespace koksma;

TEST_CASE("the calibration kernel runs, takes time and is counted", "[device][timing]") {
  Calibration calibration(test::device());
  CHECK(calibration.launches() == 0);
  std::vector<double> times(9);
  for (double& t : times) t = calibration.run();
  CHECK(calibration.launches() == times.size());
  std::sort(times.begin(), times.end());
  CHECK(times.front() > 1e-6);  // it was not optimised away
  CHECK(calibration.wall_s() >= times.front() * static_cast<double>(times.size()));
}

TEST_CASE("a calibration kernel has a name, of what is launched", "[unit]") {
  DeviceFacts cpu, gpu;
  gpu.is_cpu = false;
  gpu.max_work_group_size = 1024;
  const std::string name = Calibration::identity(cpu);
  CHECK(name.size() == 16);
  CHECK(name.find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(name != Calibration::identity(gpu));
  cpu.name = "another, of another number of cores";
  cpu.compute_units = 64;
  CHECK(name == Calibration::identity(cpu));
}

TEST_CASE("every timed launch has a calibration beside it, and long launches are not repeated",
          "[device][timing]") {
  for (const char* sampler : {"sobol-owen", "latin"}) {  // one table for all N, and one for each
    // Replicates enough to keep all compute units busy.
    const std::uint32_t replicates = std::max(32U, 8 * test::device().facts().compute_units);
    Cell cell = test::cell("linear-prod:d=2", sampler, 256, replicates);
    cell.n = {256, 512, 1024};
    PreparedCell prepared(test::catalog(), test::device(), test::device(),
                          make_plan(test::catalog(), cell, test::device().facts()));
    const CellResult result = prepared.run();
    INFO(sampler);
    REQUIRE(result.rows.size() == 3);
    std::size_t launches = 0;
    for (const Row& row : result.rows) {
      CHECK(row.kernel_times.size() >= 3);
      CHECK(row.kernel_times.size() <= 16);
      CHECK(row.calibration.size() == row.kernel_times.size());
      CHECK(row.kernel.count == row.kernel_times.size());
      // Merged and waited for one by one are five runs; launches of rows this short make several.
      CHECK(row.wall.count ==
            (row.runs_per_launch > 1 ? 5 : std::min<std::size_t>(5, row.kernel.count)));
      CHECK(row.kernel.min == *std::min_element(row.kernel_times.begin(), row.kernel_times.end()));
      for (const double t : row.calibration) CHECK(t > 1e-6);
      launches += row.kernel_times.size();
    }
    CHECK(result.rows.front().runs_per_launch > 1);
    // Short launches share calibrations: fewer than launches, at least one before and one after.
    CHECK(prepared.calibration().launches() >= 2);
    CHECK(prepared.calibration().launches() < launches);
  }
}

TEST_CASE("a launch is set beside the mean of the calibrations before and after it", "[unit]") {
  CHECK(calibration_between(1e-4, 1.44e-4) == Approx(1.2e-4));
  CHECK(calibration_between(1.44e-4, 1e-4) == Approx(1.2e-4));
  // One of them met another process.
  CHECK(calibration_between(1e-4, 2.1e-4) == 1e-4);
  CHECK(calibration_between(4e-3, 1e-4) == 1e-4);
}

TEST_CASE("a share of a row's launches is a share of what is enough", "[unit]") {
  // 16 launches, 20 ms of them and three, or 60 ms.
  CHECK_FALSE(enough_launches(15, 1e-3, 16));
  CHECK(enough_launches(16, 1e-3, 16));
  CHECK_FALSE(enough_launches(2, 30e-3, 16));
  CHECK(enough_launches(3, 21e-3, 16));
  CHECK(enough_launches(1, 61e-3, 16));
  CHECK_FALSE(enough_launches(3, 1e-3, 16, 0.25));
  CHECK(enough_launches(4, 1e-3, 16, 0.25));
  CHECK(enough_launches(1, 6e-3, 16, 0.25));
  CHECK_FALSE(enough_launches(1, 11e-3, 16, 0.5));
  CHECK(enough_launches(2, 11e-3, 16, 0.5));
  CHECK(enough_launches(1, 31e-3, 16, 0.5));
}

TEST_CASE("a cell is timed in passes, each of them its share of the launches", "[device][timing]") {
  Cell cell = test::cell("linear-prod:d=2", "sobol-owen", 256, 32);
  cell.n = {256, 512, 1 << 16};
  const auto prepare = [&] {
    return PreparedCell(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell, test::device().facts()));
  };
  PreparedCell in_steps = prepare();
  in_steps.start();
  std::vector<CellResult> after{in_steps.result()};
  while (in_steps.unfinished()) {
    in_steps.time_again();
    after.push_back(in_steps.result());
  }
  // Fewer passes where a machine is so slow that they have enough.
  REQUIRE(after.size() > 1);
  REQUIRE(after.size() <= kPasses);
  for (std::size_t pass = 0; pass < after.size(); ++pass) {
    REQUIRE(after[pass].rows.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      INFO("N = " << cell.n[i] << ", pass " << pass);
      const Row& row = after[pass].rows[i];
      CHECK(row.kernel.count == row.kernel_times.size());
      CHECK(row.calibration.size() == row.kernel_times.size());
      CHECK(row.kernel.count <= std::max<std::size_t>(kMergedRuns, 4 * (pass + 1)));  // of 16
      CHECK(row.kernel.count >= (pass == 0 ? 1 : after[pass - 1].rows[i].kernel.count));
      CHECK(row.estimates == after.front().rows[i].estimates);
    }
  }
  CHECK(after.back().rows.front().kernel.count >= 3);
  CHECK(prepare().run().rows.back().estimates == after.back().rows.back().estimates);

  // One launch of each is enough, or a rule that stops by time needs each row's before it goes on:
  // one pass.
  const auto in_one_pass = [&] {
    PreparedCell prepared = prepare();
    prepared.start();
    CHECK_FALSE(prepared.unfinished());
    CHECK_FALSE(prepared.result().rows.empty());
  };
  cell.launches = 1;
  in_one_pass();
  cell.launches.reset();
  cell.stop.time_budget = 0.05;
  in_one_pass();
}

TEST_CASE("launches lie between two calibrations", "[device]") {
  Calibration calibration(test::device());
  TimedLaunches timed(calibration);
  std::vector<Row> rows(2);
  rows[0].n = 1;
  rows[1].n = 2;
  for (int round = 0; round < 4; ++round) {
    timed.add_merged(rows[0], 1e-3, 1e-3);
    if (round < 2)
      timed.add_merged(rows[1], 8e-3, 11e-3);  // more than the 5 ms between calibrations
    else
      timed.add(rows[1], 8e-3, 11e-3);
  }
  CHECK(timed.merged(1) == 4);
  CHECK(timed.merged(2) == 2);
  timed.pause();  // nothing is left to be calibrated
  timed.finish(rows, 0);
  // One calibration at first, then two after every pair of launches, for 12 ms of them.
  CHECK(calibration.launches() == 1 + 4 * 2);
  CHECK(rows[0].calibration == rows[1].calibration);  // both lie between the same two
  CHECK(std::set<double>(rows[0].calibration.begin(), rows[0].calibration.end()).size() > 1);
  CHECK(rows[0].kernel.median == 1e-3);
  CHECK(rows[1].wall.count == 2);
  CHECK(rows[1].kernel.count == 4);
  CHECK(timed.spent(2) == Approx(4 * 11e-3));

  // After a pause one before the next launch.
  timed.resume();
  CHECK(calibration.launches() == 1 + 4 * 2 + 1);
  timed.add(rows[0], 1e-3, 1e-3);
  timed.pause();
  CHECK(calibration.launches() == 1 + 4 * 2 + 2);
}
