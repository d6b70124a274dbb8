// Efficiency, time to a tolerance, speed-up.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "estimate/efficiency.hpp"

namespace koksma {
namespace {

// RMSE = T^-1 at T = 1, 2, 4, …, 64.
std::vector<TimePoint> inverse_curve() {
  std::vector<TimePoint> rows;
  for (int k = 0; k <= 6; ++k) rows.push_back({std::exp2(k), std::exp2(-k)});
  return rows;
}

}  // namespace

TEST_CASE("efficiency and variance reduction are those computed by hand", "[unit][estimate]") {
  CHECK(*efficiency(0.1, 4) == Approx(25));
  CHECK(*variance_reduction(2, 50, 0.1) == Approx(4));
  CHECK(*speed_up({2, 0.1}, {1, 0.01}) == Approx(200));
  CHECK(*speed_up({2, 0.1}, {1, 0.01}) == Approx(*efficiency(0.01, 1) / *efficiency(0.1, 2)));
}

TEST_CASE("quantities without a meaning are absent", "[unit][estimate]") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_FALSE(efficiency(0, 1));
  CHECK_FALSE(efficiency(1, 0));
  CHECK_FALSE(efficiency(std::nan(""), 1));
  CHECK_FALSE(efficiency(1e-200, 1));
  CHECK_FALSE(variance_reduction(infinity, 8, 0.1));
  CHECK_FALSE(variance_reduction(1, 0, 0.1));
  CHECK_FALSE(speed_up({1, 0}, {1, 1}));
  CHECK_FALSE(speed_up({1, 1}, {-1, 1}));
}

TEST_CASE("a power law is interpolated exactly, in any order of rows", "[unit][estimate]") {
  std::vector<TimePoint> rows = inverse_curve();
  for (const double tolerance : {1.0, 0.7, 0.3, 0.1, 1.0 / 64}) {
    const TimeToTolerance t = time_to_tolerance(rows, tolerance);
    CHECK(*t.seconds == Approx(1 / tolerance));
    CHECK_FALSE(t.extrapolated);
    std::swap(rows[1], rows[5]);
    std::swap(rows[0], rows[4]);
  }
}

TEST_CASE("extrapolation reaches one octave and is flagged", "[unit][estimate]") {
  const std::vector<TimePoint> rows = inverse_curve();
  for (const double tolerance : {1.0 / 127, 1.9}) {
    const TimeToTolerance t = time_to_tolerance(rows, tolerance);
    REQUIRE(t.seconds);
    CHECK(*t.seconds == Approx(1 / tolerance));
    CHECK(t.extrapolated);
  }
  for (const double tolerance : {1.0 / 129, 2.1}) {
    const TimeToTolerance t = time_to_tolerance(rows, tolerance);
    CHECK_FALSE(t.seconds);
    CHECK_FALSE(t.extrapolated);
    CHECK_FALSE(t.reason.empty());
  }
}

TEST_CASE("a lucky early row does not count as reaching the tolerance", "[unit][estimate]") {
  const std::vector<TimePoint> rows = {{1, 1}, {2, 0.01}, {4, 0.25}, {8, 0.125}};
  CHECK(*time_to_tolerance(rows, 0.2).seconds == Approx(5));
}

TEST_CASE("a curve that does not fall is not extrapolated", "[unit][estimate]") {
  const std::vector<TimePoint> plateau = {{1, 1}, {2, 0.5}, {4, 0.5}};
  CHECK_FALSE(time_to_tolerance(plateau, 0.4).seconds);
  CHECK_FALSE(time_to_tolerance(plateau, 0.4).reason.empty());
}

TEST_CASE("rows without a positive time and error are ignored", "[unit][estimate]") {
  std::vector<TimePoint> rows = inverse_curve();
  rows.push_back({0, 1e-9});
  rows.push_back({128, 0});
  rows.push_back({256, std::nan("")});
  CHECK(*time_to_tolerance(rows, 0.1).seconds == Approx(10));
  CHECK_FALSE(time_to_tolerance(std::vector<TimePoint>{{1, 1}}, 0.5).seconds);
  CHECK_FALSE(time_to_tolerance(rows, 0).seconds);
}

}  // namespace koksma
