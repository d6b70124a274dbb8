// koksma compare: what kernels do not follow of the calibration's change counts.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "report/compare.hpp"
#include "report/compare_report.hpp"
#include "report/compare_times.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// Times, in four passes over the cells, of a machine that for about a second at a time, a third of
// all, slows down the calibration kernel by 1.6 and others by 1.1; times `factor`.
Json timed_beside_others(std::uint64_t seed, double factor = 1) {
  Json results = test::recorded_study();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 0.03);
  std::exponential_distribution<double> quiet(1 / 2.0), busy(1 / 1.0);
  bool shared = random() % 3 == 0;
  double clock = 0, until = shared ? busy(random) : quiet(random);
  for (Json& cell : results["cells"])
    for (Json& row : cell["rows"]) row["kernel_times_s"] = row["calibration_s"] = Json::array();
  for (int pass = 0; pass < 4; ++pass)
    for (Json& cell : results["cells"])
      for (Json& row : cell["rows"])
        for (int round = 0; round < 3; ++round) {
          for (clock += 0.01; clock > until; shared = !shared)
            until += shared ? quiet(random) : busy(random);
          row["kernel_times_s"].push_back(factor * 1e-8 * row["n"].get<double>() *
                                          (shared ? 1.1 : 1) * std::exp(normal(random)));
          row["calibration_s"].push_back(5e-5 * (shared ? 1.6 : 1) * std::exp(normal(random)));
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

TEST_CASE("what rows follow of the calibration is the slope within their runs", "[unit]") {
  // Rows of 16 launches, each unlike the others, the second half beside a calibration that is
  // slower by `apart`, of which they follow `share`; every fifth is disturbed.
  const auto rows = [](double share, double apart, double noise = 1e-4) {
    std::vector<Launches> all;
    for (std::size_t i = 0; i < 21; ++i) {
      Launches row;
      for (std::size_t k = 0; k < 16; ++k) {
        const double sign = (k + i) % 2 == 0 ? 1 : -1, slower = k < 8 ? 0 : apart;
        row.times.push_back(static_cast<double>(i) + share * slower + (k % 5 == 0 ? 0.4 : 0) -
                            noise * sign);
        row.calibrations.push_back(0.1 * static_cast<double>(i % 2) + slower + noise * sign);
      }
      all.push_back(row);
    }
    return all;
  };
  CHECK(share_within(rows(0.25, 0.5)).value() == Approx(0.25).margin(1e-3));
  CHECK(share_within(rows(1.2, -0.3)).value() == Approx(1.2).margin(2e-3));
  CHECK(share_within(rows(-0.2, 0.5)).value() == 0);
  // Noise has no slope, whatever it is: this one's is -1.
  CHECK(share_within(rows(0.25, 1, 0.05)).value() == Approx(0.25).margin(0.03));
  CHECK_FALSE(share_within(rows(0.25, 0, 0.2)).has_value());
  // As fast throughout, or hardly ever not.
  CHECK_FALSE(share_within(rows(0.25, 0.13)).has_value());
  std::vector<Launches> few = rows(0.25, 0);
  few.front() = rows(0.25, 0.5).front();  // 64 of 2520 pairs
  CHECK_FALSE(share_within(few).has_value());
  CHECK_FALSE(share_within({}).has_value());
  // More rows than pairs are made of.
  std::vector<Launches> many;
  for (int k = 0; k < 300; ++k)
    for (const Launches& row : rows(0.5, 0.5)) many.push_back(row);
  CHECK(share_within(many).value() == Approx(0.5).margin(1e-3));
}

TEST_CASE("where runs tell nothing of it, the slope is that of rows between them", "[unit]") {
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
  CHECK(share_between(rows(0.25, 10)).value() == Approx(0.25));
  CHECK(share_between(rows(0.9, 10)).value() == 1);
  CHECK(share_between(rows(-0.2, 10)).value() == 0);
  CHECK_FALSE(share_between(rows(0.25, 0)).has_value());
  CHECK_FALSE(share_between(rows(0.25, 1)).has_value());  // 20 of 210 pairs, less than a tenth
  CHECK_FALSE(share_between(rows(0.25, 21)).has_value());
  CHECK_FALSE(share_between({}).has_value());
}

TEST_CASE("changes are what is left of times", "[unit]") {
  const auto run = [](double time, double calibration) {
    return Launches{{time, time, time}, {calibration, calibration, calibration}};
  };
  const Launches base = run(0, 0);
  const auto shift = [](const Stratum& row) { return shift_estimate(row.a, row.b); };
  // Of a row that took twice as long beside a calibration that did so too.
  CHECK(shift(less_followed(base, run(0.7, 0.7), 1)) == Approx(0).margin(1e-15));
  CHECK(shift(less_followed(base, run(0.7, 0.7), 0.25)) == Approx(0.75 * 0.7));
  CHECK(shift(less_followed(base, run(0.7, 0.7), 0)) == Approx(0.7));
  // Where runs do not tell the share it is 1 at about equal speed, else that between them, and
  // where nobody knows it the smaller change counts, none where the two disagree about its
  // direction.
  const auto counted = [&](double time, double calibration, std::optional<double> between = {}) {
    return shift(followed_by_speed(base, run(time, calibration), between));
  };
  CHECK(counted(0.3, 0.2) == Approx(0.1));
  CHECK(counted(0.3, -0.2, 0.5) == Approx(0.5));
  CHECK(counted(0.7, 0.5, 0.2) == Approx(0.6));
  CHECK(counted(0.7, 0.5) == Approx(0.2));
  CHECK(counted(0.2, 0.5) == Approx(0).margin(1e-15));
  CHECK(counted(0.2, -0.5) == Approx(0.2));
  CHECK(counted(-0.7, -0.5) == Approx(-0.2));
}

TEST_CASE("two runs at different speeds are told, and the smaller change counts", "[unit]") {
  // Launches of a machine that is as fast throughout a run, `speed` times as slow as usual, with
  // times that are `longer`.
  const auto run = [](double longer, double speed) {
    Json results = test::recorded_study();
    for (Json& cell : results["cells"])
      for (Json& row : cell["rows"]) {
        row["kernel_times_s"] = row["calibration_s"] = Json::array();
        for (int k = 0; k < 12; ++k) {
          const double noise = 1 + 0.01 * (k % 3);
          row["kernel_times_s"].push_back(1e-8 * row["n"].get<double>() * longer * noise);
          row["calibration_s"].push_back(5e-5 * speed * noise);
        }
      }
    return results;
  };
  const Json base = run(1, 1);
  const auto beside = [&](double longer) { return compare_results(base, run(longer, 2), {}); };
  const auto told = [](const Comparison& c) {
    return std::any_of(c.notes.begin(), c.notes.end(), [](const std::string& note) {
      return note.find("as fast throughout each run, but not in both") != std::string::npos;
    });
  };
  const Comparison as_fast = beside(2);
  CHECK(as_fast.rows_timed > 10);
  CHECK_FALSE(as_fast.calibration_followed.has_value());
  CHECK(as_fast.calibration_ratio == Approx(2));
  CHECK(told(as_fast));
  CHECK(as_fast.study.ratio == Approx(1));
  CHECK(beside(2 * 1.3).study.ratio == Approx(1.3));
  CHECK(beside(2 * 1.3).study.change == Change::worse);
  CHECK(beside(1.1).study.ratio == Approx(1));  // longer as it is, shorter as a multiple
  CHECK_FALSE(told(compare_results(base, base, {})));
}

TEST_CASE("of runs that knew several speeds the share is taken out and told", "[unit]") {
  const Comparison same = compare_results(timed_beside_others(0), timed_beside_others(1), {});
  REQUIRE(same.calibration_followed.has_value());
  CHECK(*same.calibration_followed == Approx(std::log(1.1) / std::log(1.6)).margin(0.05));
  CHECK(compare_json(same)["calibration_followed"] == *same.calibration_followed);
  CHECK(compare_table(same).find("followed by 0.2") != std::string::npos);
}
