// koksma compare: launches count that both runs made while the device was about as fast.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "report/compare.hpp"
#include "report/compare_times.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// Times of a machine that for about a second at a time, a third of all, slows down the calibration
// kernel by 1.6 and others by 1.1; times `factor`.
Json timed_beside_others(std::uint64_t seed, double factor = 1) {
  Json results = test::recorded_study();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 0.03);
  std::exponential_distribution<double> quiet(1 / 2.0), busy(1 / 1.0);
  bool shared = random() % 3 == 0;
  double clock = 0, until = shared ? busy(random) : quiet(random);
  for (Json& cell : results["cells"]) {
    for (Json& row : cell["rows"]) {
      row["kernel_times_s"] = row["calibration_s"] = Json::array();
      for (int round = 0; round < 12; ++round) {
        for (clock += 0.01; clock > until; shared = !shared)
          until += shared ? quiet(random) : busy(random);
        row["kernel_times_s"].push_back(factor * 1e-8 * row["n"].get<double>() *
                                        (shared ? 1.1 : 1) * std::exp(normal(random)));
        row["calibration_s"].push_back(5e-5 * (shared ? 1.6 : 1) * std::exp(normal(random)));
      }
    }
  }
  return results;
}

}  // namespace

TEST_CASE("what the calibration feels more than a kernel does is no change and hides none",
          "[statistical]") {
  // 60 pairs of runs of 5 s. Of 6000 none alarmed and one was missed: an alarm among 60 is less
  // likely than 0.03, four missed than 1e-4 (95 % limits of the rates, 5e-4 and 8e-4).
  int alarms = 0, found = 0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    const Json base = timed_beside_others(2 * k);
    alarms +=
        compare_results(base, timed_beside_others(2 * k + 1), {}).study.change != Change::none;
    found += compare_results(base, timed_beside_others(2 * k + 1, 1.3), {}).study.change ==
             Change::worse;
  }
  CHECK(alarms == 0);
  CHECK(found >= 57);
}

TEST_CASE("launches are compared that were made at equal speed", "[unit]") {
  // 16 launches each, at the logarithms of speeds and times that are given for both halves.
  const auto halves = [](double time, double speed, double later_time, double later_speed) {
    Launches run;
    for (int i = 0; i < 16; ++i) {
      run.times.push_back(i < 8 ? time : later_time);
      run.calibrations.push_back(i < 8 ? speed : later_speed);
    }
    return run;
  };
  const Launches usual = halves(0, 0, 0, 0);
  const ComparedLaunches half = at_equal_speed(usual, halves(0.2, 0, 0.9, 0.5));
  CHECK(half.equal_speed);
  CHECK(half.times.a.size() == 16);
  CHECK(half.times.b == std::vector<double>(8, 0.2));
  // One calibration that was disturbed, or noise in all of them, chooses nothing.
  Launches noisy = usual;
  for (std::size_t i = 0; i < 16; ++i) noisy.calibrations[i] = i == 5 ? 1 : i % 2 ? 0.08 : -0.08;
  CHECK(at_equal_speed(usual, noisy).times.b.size() == 16);
  // No speed in common: all launches, as multiples.
  const Launches slower = halves(0.7, 0.5, 0.7, 0.5);
  const ComparedLaunches none = at_equal_speed(usual, slower);
  CHECK_FALSE(none.equal_speed);
  CHECK(none.times.b == std::vector<double>(16, 0.7 - 0.5));
  // Then the smaller change counts, none where the two ratios disagree about its direction.
  const auto shift = [&](const Launches& now) {
    const Stratum moved = nearest_to_unchanged(usual, now);
    return shift_estimate(moved.a, moved.b);
  };
  CHECK(shift(slower) == Approx(0.2));
  CHECK(shift(halves(0.2, 0.5, 0.2, 0.5)) == Approx(0).margin(1e-15));
  CHECK(shift(halves(0.2, -0.5, 0.2, -0.5)) == Approx(0.2));
  CHECK(shift(halves(-0.7, -0.5, -0.7, -0.5)) == Approx(-0.2));
}

TEST_CASE("how much of the calibration's change rows follow is the slope over them", "[unit]") {
  // 21 rows, slower by 0.3 of everything; half of them at another speed, and every fifth slower
  // still.
  const auto rows = [](double share, std::size_t at_other_speed) {
    std::vector<RowShift> shifts;
    for (std::size_t i = 0; i < 21; ++i) {
      const double calibration = (i < at_other_speed ? 0.5 : 0) + 0.01 * static_cast<double>(i % 3);
      shifts.push_back({0.3 + share * calibration + (i % 5 == 0 ? 0.4 : 0), calibration});
    }
    return shifts;
  };
  CHECK(share_followed(rows(0.25, 10)).value() == Approx(0.25));
  CHECK(share_followed(rows(0.9, 10)).value() == 1);
  CHECK(share_followed(rows(-0.2, 10)).value() == 0);
  CHECK_FALSE(share_followed(rows(0.25, 0)).has_value());
  CHECK_FALSE(share_followed(rows(0.25, 1)).has_value());  // 20 of 210 pairs, less than a tenth
  CHECK_FALSE(share_followed(rows(0.25, 21)).has_value());
  CHECK_FALSE(share_followed({}).has_value());
  // What is left of a row that took twice as long beside a calibration that did so too.
  const Launches base{{0, 0, 0}, {0, 0, 0}}, now{{0.7, 0.7, 0.7}, {0.7, 0.7, 0.7}};
  const auto left = [&](double followed) {
    const Stratum row = less_followed(base, now, followed);
    return shift_estimate(row.a, row.b);
  };
  CHECK(left(1) == Approx(0).margin(1e-15));
  CHECK(left(0.25) == Approx(0.75 * 0.7));
}

TEST_CASE("two runs at different speeds are told, and the smaller change counts", "[unit]") {
  // The same times on a machine of half the speed, and times that are `longer` on it.
  const Json base = timed_beside_others(1);
  const auto beside = [&](double longer) {
    Json now = base;
    for (Json& cell : now["cells"])
      for (Json& row : cell["rows"]) {
        for (Json& t : row["kernel_times_s"]) t = longer * t.get<double>();
        for (Json& t : row["calibration_s"]) t = 2 * t.get<double>();
      }
    return compare_results(base, now, {});
  };
  const auto told = [](const Comparison& c) {
    return std::any_of(c.notes.begin(), c.notes.end(), [](const std::string& note) {
      return note.find("seldom as fast in one run as in the other (0 of ") != std::string::npos;
    });
  };
  const Comparison as_fast = beside(2);
  CHECK(as_fast.rows_timed > 10);
  CHECK(as_fast.rows_at_equal_speed == 0);
  CHECK(told(as_fast));
  CHECK(as_fast.study.ratio == Approx(1));
  CHECK(as_fast.cells[1].time.reason == "not timed at equal speed");
  CHECK(beside(2 * 1.3).study.ratio == Approx(1.3));
  CHECK(beside(2 * 1.3).study.change == Change::worse);
  CHECK(beside(1.1).study.ratio == Approx(1));  // longer as it is, shorter as a multiple
  const Comparison itself = compare_results(base, base, {});
  CHECK(itself.rows_at_equal_speed == itself.rows_timed);
  CHECK_FALSE(told(itself));
}
