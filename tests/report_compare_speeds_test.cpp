// koksma compare: what kernels do not follow of the calibration's change counts.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "report/compare.hpp"
#include "report/compare_report.hpp"
#include "report/compare_share.hpp"
#include "report/compare_times.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

// Times, in four passes over the cells, of a machine that for about a second at a time, a third of
// all, slows down the calibration kernel by 1.6 and others by 1.1; times `factor`, calibrations
// times `clock_factor`.
Json timed_beside_others(std::uint64_t seed, double factor = 1, double clock_factor = 1) {
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
          row["calibration_s"].push_back(clock_factor * 5e-5 * (shared ? 1.6 : 1) *
                                         std::exp(normal(random)));
        }
  return results;
}

}  // namespace

TEST_CASE("what the calibration feels more than a kernel does is no change and hides none",
          "[statistical]") {
  // 60 pairs of runs of 5 s. Of 300 none alarmed and none was missed: a rate of 0.01 would have
  // shown with probability 0.95, so an alarm among 60 is less likely than 0.45, four missed than
  // 0.004.
  int alarms = 0, found = 0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    const Json base = timed_beside_others(2 * k);
    alarms += compare_results(base, timed_beside_others(2 * k + 1), {}).regression();
    found += compare_results(base, timed_beside_others(2 * k + 1, 1.3), {}).study.change ==
             Change::worse;
  }
  CHECK(alarms == 0);
  CHECK(found >= 57);
}

TEST_CASE("what rows follow of the calibration is the slope within their runs", "[unit]") {
  // Rows of 16 launches, each unlike the others, `stretch` of them after each other beside a
  // calibration that is slower by `apart`, of which they follow `share`; every fifth is disturbed.
  // What is noise makes times longer where it makes calibrations shorter.
  const auto rows = [](double share, double apart, double noise = 1e-4, double stretch = 8) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal(0, noise);
    std::vector<Launches> all;
    for (std::size_t i = 0; i < 21; ++i) {
      Launches row;
      for (std::size_t k = 0; k < 16; ++k) {
        const double x = normal(random),
                     slower =
                         static_cast<int>(static_cast<double>(k) / stretch) % 2 == 0 ? 0 : apart;
        row.times.push_back(static_cast<double>(i) + share * slower + (k % 5 == 0 ? 0.4 : 0) - x);
        row.calibrations.push_back(0.1 * static_cast<double>(i % 2) + slower + x);
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
  // Nor are steps noise, where most launches begin with one.
  CHECK(share_within(rows(0.25, 0.5, 0.01, 1.6)).value() == Approx(0.25).margin(0.05));
  // As fast throughout, or hardly ever not.
  CHECK_FALSE(share_within(rows(0.25, 0.13)).has_value());
  std::vector<Launches> few = rows(0.25, 0);
  few.front() = rows(0.25, 0.5).front();  // 64 of 2520 pairs
  CHECK_FALSE(share_within(few).has_value());
  CHECK_FALSE(share_within({}).has_value());
  // Three calibrations that were disturbed, and that all rows share, are no other speed.
  std::vector<Launches> disturbed = rows(0.25, 0);
  for (Launches& row : disturbed)
    for (const std::size_t k : {3U, 7U, 11U})
      row.calibrations[k] = 0.4 + 0.01 * static_cast<double>(k);
  CHECK_FALSE(share_within(disturbed).has_value());
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
}

TEST_CASE("a device's own speed explains what times do that follow more of it, or less", "[unit]") {
  const auto explained = [](double share, double clock, double low, double high, double least,
                            double most) {
    const Followed followed{.share = share, .clock = clock, .least = share};
    const Interval of_all = followed.explained(), of_one = followed.explained_of_one();
    CHECK(of_all.low == Approx(low).margin(1e-15));
    CHECK(of_all.high == Approx(high).margin(1e-15));
    CHECK(of_one.low == Approx(least).margin(1e-15));
    CHECK(of_one.high == Approx(most).margin(1e-15));
  };
  explained(0.25, 0, 0, 0, 0, 0);
  explained(0.25, 0.4, 0, 0.3, -0.1, 0.3);
  explained(0.25, -0.4, -0.3, 0, -0.3, 0.1);
  explained(1.2, 0.5, 0, 0, -0.6, 0);
  const Interval unknown = Followed{.share = 1, .clock = 0.1, .least = 0}.explained();
  CHECK(unknown.low == Approx(-0.1));
  CHECK(unknown.high == 0);
  // 20 % beyond the threshold and beyond noise, unless so much is explained.
  const auto decided = [](double ratio, const Interval& by_speed, double spread = 0) {
    TimeChange time;
    time.ratio = ratio;
    time.p = 1e-9;
    decide(time, 0.15, 0.001, spread, 100, by_speed);
    return time.change;
  };
  CHECK(decided(1.2, {-1, 0}) == Change::worse);
  CHECK(decided(1.2, {0, 0.02}) == Change::worse);
  CHECK(decided(1.2, {0, 0.1}) == Change::undecided);
  CHECK(decided(1.2, {0, 1}) == Change::undecided);
  CHECK(decided(1.1, {0, 1}) == Change::none);
  CHECK(decided(1 / 1.2, {0, 1}) == Change::better);
  CHECK(decided(1 / 1.2, {-0.1, 0}) == Change::undecided);
  CHECK(decided(1.2, {0, 0.02}, std::log(1.2) / 3.3) == Change::undecided);
  CHECK(decided(1.2, {0, 0.02}, std::log(1.2) / 3) == Change::none);
}

TEST_CASE("what is known of the share depends on the speeds that the runs knew", "[unit]") {
  // Rows of 12 launches of a run, as many of them as `slow` beside calibrations 0.5 slower, of
  // which they follow a quarter; everything slower by `all`, every other row by `uneven` more, of
  // which it follows a half.
  const auto run = [](std::size_t slow, double all, double uneven = 0) {
    std::vector<Launches> rows(20);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t k = 0; k < 12; ++k) {
        const double speed = k < slow ? 0.5 : 0, odd = i % 2 == 0 ? 0 : uneven;
        rows[i].times.push_back(0.25 * speed + all + 0.5 * odd);
        rows[i].calibrations.push_back(speed + all + odd + 1e-6 * static_cast<double>(12 * i + k));
      }
    return rows;
  };
  const auto found = [&](const std::vector<Launches>& now, const std::vector<Launches>& base,
                         double share, double clock) {
    const Followed followed = what_is_followed(base, now);
    CHECK(followed.share == Approx(share).margin(1e-3));
    CHECK(followed.clock == Approx(clock).margin(1e-3));
  };
  found(run(6, 0), run(4, 0), 0.25, 0);
  found(run(6, 0.1), run(4, 0), 0.25, 0.1);
  found(run(4, 0.4), run(4, 0), 0.25, 0.4);
  found(run(2, 0), run(6, 0.4), 0.25, -0.4);
  found(run(12, 0), run(4, 0), 0.25, 0.5);  // a neighbour throughout looks like a clock
  found(run(0, 0.1), run(0, 0), 1, 0.1);    // about as fast, throughout
  CHECK(what_is_followed(run(0, 0), run(0, 0.1)).least == 0);  // as nobody knows
  found(run(0, 0.3), run(0, 0), 0, 0.3);                       // at another speed throughout
  found(run(0, 0.1, 0.4), run(0, 0), 0.5, 0.3);                // and rows at different ones
}

TEST_CASE("between two runs at different speeds what these explain is undecided", "[unit]") {
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
  const Comparison as_fast = beside(2);
  CHECK(as_fast.rows_timed > 10);
  CHECK(as_fast.calibration_followed == 0);
  CHECK(as_fast.clock_ratio == Approx(2));
  CHECK(as_fast.explained.low == 1);
  CHECK(as_fast.explained.high == Approx(2));
  CHECK(as_fast.calibration_ratio == Approx(2));
  CHECK(as_fast.study.ratio == Approx(2));
  CHECK(as_fast.study.change == Change::undecided);
  CHECK_FALSE(as_fast.regression());
  CHECK_THAT(compare_table(as_fast),
             Catch::Contains("no regression, but changes that are UNDECIDED") &&
                 Catch::Contains("device itself was 2.00 times as slow as before") &&
                 Catch::Contains(" undecided\n"));
  CHECK(compare_json(as_fast)["undecided"] == true);
  CHECK(compare_json(as_fast)["study"]["change"] == "undecided");
  CHECK(beside(2 * 1.3).study.change == Change::worse);
  // What nobody knows is undecided at a smaller threshold too.
  const auto at_three = [&](double longer, double speed) {
    return compare_results(base, run(longer, speed), {.threshold = 0.03});
  };
  CHECK(at_three(1.1, 1.1).study.change == Change::none);
  CHECK(at_three(1, 1.1).study.change == Change::undecided);
  CHECK(at_three(1, 1 / 1.1).study.change == Change::undecided);
  CHECK(at_three(1.2, 1.1).study.change == Change::worse);
  CHECK(beside(1.1).study.change == Change::none);
  CHECK_FALSE(beside(1.1).undecided());
  CHECK(compare_results(base, base, {}).clock_ratio == 1);
}

TEST_CASE("of runs that knew several speeds the share is taken out and told", "[unit]") {
  const Comparison same = compare_results(timed_beside_others(0), timed_beside_others(1), {});
  REQUIRE(same.calibration_followed.has_value());
  const double share = *same.calibration_followed;
  CHECK(same.clock_ratio == Approx(1).epsilon(0.05));
  CHECK(share == Approx(std::log(1.1) / std::log(1.6)).margin(0.05));
  CHECK(compare_json(same)["calibration_followed"] == share);
  CHECK(compare_table(same).find("followed by 0.2") != std::string::npos);
}

TEST_CASE("a slower clock is no regression, what is slower beside it is one", "[statistical]") {
  // The share within runs, 0.2, is not that of the clock. 60 pairs: of 300 2 alarmed, where a
  // neighbour was there throughout the base and hid the clock, and none was missed; more than two
  // of 60 are less likely than 0.01 then.
  int alarms = 0, found = 0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    const Json base = timed_beside_others(2 * k);
    const auto beside_slower_clock = [&](double factor) {
      return compare_results(base, timed_beside_others(2 * k + 1, 1.5 * factor, 1.5), {});
    };
    alarms += beside_slower_clock(1).regression();
    found += beside_slower_clock(1.3).study.change == Change::worse;
  }
  CHECK(alarms <= 2);
  CHECK(found >= 57);
  const Comparison one =
      compare_results(timed_beside_others(2), timed_beside_others(3, 1.5, 1.5), {});
  CHECK(one.clock_ratio == Approx(1.5).epsilon(0.05));
  CHECK(one.study.change == Change::undecided);
}

TEST_CASE("a cell that follows a neighbour less than others do is no regression", "[statistical]") {
  // The neighbour is there throughout the base: calibrations take 1.6 times as long, times 1.5,
  // those of one cell 1.1. In both runs a clock is 1.4 times as slow for a third of the time, for
  // all. Of 200 pairs none alarmed.
  const auto run = [](std::uint64_t seed, bool shared) {
    Json results = timed_beside_others(seed);
    for (std::size_t i = 0; i < results["cells"].size(); ++i)
      for (Json& row : results["cells"][i]["rows"])
        for (std::size_t k = 0; k < row["kernel_times_s"].size(); ++k) {
          const bool slow = row["calibration_s"][k].get<double>() > 6.5e-5;
          const double clock = slow ? 1.4 : 1, neighbour = shared ? (i == 1 ? 1.1 : 1.5) : 1;
          row["calibration_s"][k] =
              row["calibration_s"][k].get<double>() / (slow ? 1.6 : 1) * clock * (shared ? 1.6 : 1);
          row["kernel_times_s"][k] =
              row["kernel_times_s"][k].get<double>() / (slow ? 1.1 : 1) * clock * neighbour;
        }
    return results;
  };
  int alarms = 0, undecided = 0;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const Comparison c = compare_results(run(2 * k, true), run(2 * k + 1, false), {});
    alarms += c.regression();
    undecided += c.cells[1].time.change == Change::undecided;
    CHECK(c.calibration_followed.value_or(1) == Approx(1).margin(0.2));
  }
  CHECK(alarms == 0);
  CHECK(undecided >= 15);
  // Nor is a study of that cell alone.
  Json base = run(0, true), now = run(1, false);
  for (Json* results : {&base, &now}) (*results)["cells"] = Json::array({(*results)["cells"][1]});
  CHECK(compare_results(base, now, {}).study.change == Change::undecided);
}

TEST_CASE("times beside another calibration kernel are not compared", "[unit]") {
  Json base = timed_beside_others(0), now = timed_beside_others(1, 2);
  base["context"]["calibration"] = "0123456789abcdef";
  now["context"]["calibration"] = "0123456789abcdee";
  const Comparison differ = compare_results(base, now, {});
  CHECK(differ.study.change == Change::unknown);
  CHECK_FALSE(differ.regression());
  CHECK_FALSE(compare_json(differ)["rows_timed"].get<int>() > 0);
  CHECK(compare_table(differ).find("the calibration kernels differ: times are not compared") !=
        std::string::npos);
  const Comparison asked = compare_results(base, now, {.across_devices = true});
  CHECK(asked.study.change == Change::worse);
  CHECK_FALSE(asked.calibration_followed.has_value());
  CHECK(compare_table(asked).find("compared as they are") != std::string::npos);
  now["context"].erase("calibration");  // as of before it was written down
  CHECK(compare_results(base, now, {}).study.change == Change::unknown);
  base["context"].erase("calibration");
  CHECK(compare_results(base, now, {}).study.change == Change::worse);
  now["context"]["revision"] = "another";
  CHECK(compare_results(base, now, {}).study.change == Change::unknown);
  now["context"]["calibration"] = base["context"]["calibration"] = "0123456789abcdef";
  CHECK(compare_results(base, now, {}).study.change == Change::worse);
}
