// Efficiency, times, tolerances and crossovers of curves computed by hand.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "estimate/efficiency.hpp"

namespace koksma {
namespace {

// RMSE = 4 / N fitted over N = 2^8 … 2^16, T = 1 + N / 4.
CurveFacts inverse_curve() {
  CurveFacts curve;
  curve.errors = ErrorLine{-1, 2, 256, 65536};
  curve.times = TimeLine{1, 0.25, 9, 0};
  return curve;
}

}  // namespace

TEST_CASE("efficiency and variance reduction are those computed by hand", "[unit][estimate]") {
  CHECK(*efficiency(0.1, 4) == Approx(25));
  CHECK(*variance_reduction(2, 50, 0.1) == Approx(4));
}

TEST_CASE("quantities without a meaning are absent", "[unit][estimate]") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_FALSE(efficiency(0, 1));
  CHECK_FALSE(efficiency(1, 0));
  CHECK_FALSE(efficiency(std::nan(""), 1));
  CHECK_FALSE(efficiency(1e-200, 1));
  CHECK_FALSE(variance_reduction(infinity, 8, 0.1));
  CHECK_FALSE(variance_reduction(1, 0, 0.1));
}

TEST_CASE("times that are a + b N give a and b, whatever the order and the size",
          "[unit][estimate]") {
  for (const double scale : {1e-9, 1.0, 1e6}) {
    std::vector<Timing> rows;
    for (const std::uint64_t n : {4096U, 256U, 65536U, 1024U})
      rows.push_back({n, scale * (3 + 0.5 * static_cast<double>(n))});
    const TimeLine line = *fit_times(rows);
    CHECK(line.overhead == Approx(3 * scale).epsilon(1e-9));
    CHECK(line.per_sample == Approx(0.5 * scale).epsilon(1e-9));
    CHECK(line.rows == 4);
    CHECK(line.largest_deviation < 1e-9);
    CHECK(seconds_at(line, 10) == Approx(8 * scale));
    CHECK(samples_in(line, 8 * scale) == Approx(10));
    CHECK(samples_in(line, 2 * scale) == 0);
  }
}

TEST_CASE("neither part of a time is negative", "[unit][estimate]") {
  // One size; faster than proportional; falling with N.
  const TimeLine one = *fit_times(std::vector<Timing>{{8, 4}, {8, 4}});
  CHECK(one.overhead == 0);
  CHECK(one.per_sample == Approx(0.5));
  const TimeLine steep = *fit_times(std::vector<Timing>{{1, 1}, {2, 4}});
  CHECK(steep.overhead == 0);
  CHECK(steep.per_sample == Approx((1 + 0.5) / (1 + 0.25)));  // sum v / sum v^2, v = N/T
  const TimeLine falling = *fit_times(std::vector<Timing>{{1, 4}, {2, 2}});
  CHECK(falling.per_sample == 0);
  CHECK(falling.overhead == Approx((0.25 + 0.5) / (0.0625 + 0.25)));  // sum u / sum u^2, u = 1/T
}

TEST_CASE("one disturbed row moves the fitted times by little", "[unit][estimate]") {
  std::vector<Timing> rows;
  for (unsigned m = 8; m <= 18; ++m) rows.push_back({std::uint64_t{1} << m, std::exp2(m)});
  rows[5].seconds *= 100;
  CHECK(fit_times(rows)->per_sample == Approx(1).epsilon(0.1));
  CHECK(fit_times(rows)->largest_deviation == Approx(99).epsilon(0.2));
}

TEST_CASE("rows without a time are no times", "[unit][estimate]") {
  CHECK_FALSE(fit_times(std::vector<Timing>{}));
  CHECK_FALSE(fit_times(std::vector<Timing>{{8, 0}, {8, -1}, {0, 1}, {8, std::nan("")}}));
  CHECK(fit_times(std::vector<Timing>{{8, 0}, {8, 2}})->rows == 1);
}

TEST_CASE("a tolerance is met where the fitted line says, in the time of its N",
          "[unit][estimate]") {
  // RMSE = 4 / N over N = 2^8 … 2^16, T = 1 + N / 4: 2^-10 at N = 2^12, in 1025.
  const CurveFacts curve = inverse_curve();
  const ToTolerance inside = to_tolerance(curve, 0x1p-10);
  CHECK(*inside.n == Approx(4096));
  CHECK(*inside.seconds == Approx(1025));
  CHECK_FALSE(inside.extrapolated);
  CHECK(inside.octaves_beyond == 0);
  CHECK(inside.reason.empty());
  CHECK_FALSE(to_tolerance(curve, error_at(*curve.errors, 256)).extrapolated);
  CHECK_FALSE(to_tolerance(curve, error_at(*curve.errors, 65536)).extrapolated);
}

TEST_CASE("a tolerance beyond the rows is marked with how far", "[unit][estimate]") {
  const ToTolerance above = to_tolerance(inverse_curve(), 0x1p-17);  // N = 2^19
  CHECK(*above.n == Approx(std::exp2(19)));
  CHECK(*above.seconds == Approx(1 + std::exp2(17)));
  CHECK(above.extrapolated);
  CHECK(above.octaves_beyond == Approx(3));
  const ToTolerance below = to_tolerance(inverse_curve(), 0x1p-4);  // N = 2^6
  CHECK(*below.n == Approx(64));
  CHECK(below.extrapolated);
  CHECK(below.octaves_beyond == Approx(2));
}

TEST_CASE("a tolerance that the curve can not be followed to has a reason and no number",
          "[unit][estimate]") {
  const auto refused = [](const CurveFacts& curve, double error, const std::string& part) {
    const ToTolerance t = to_tolerance(curve, error);
    CHECK_FALSE(t.n);
    CHECK_FALSE(t.seconds);
    CHECK_FALSE(t.extrapolated);
    CHECK_THAT(t.reason, Catch::Contains(part));
  };
  const CurveFacts good = inverse_curve();
  refused(good, 0, "not positive");
  refused(good, std::nan(""), "not positive");
  refused(good, 8, "N = 1");
  CurveFacts curve = good;
  curve.errors.reset();
  curve.no_errors = "fewer than 6 usable rows";
  refused(curve, 0x1p-10, "fewer than 6 usable rows");
  curve = good;
  curve.errors->slope = 0.01;
  refused(curve, 0x1p-10, "does not fall");
  curve = good;
  curve.level = 0x1p-9;
  curve.level_is = "the floor";
  refused(curve, 0x1p-10, "the floor");
  CHECK(to_tolerance(curve, 0x1p-9).n);
  curve = good;
  curve.most_n = 1 << 18;
  refused(curve, 0x1p-17, "beyond the sampler's 2^18");
  curve = good;
  curve.times.reset();
  CHECK(*to_tolerance(curve, 0x1p-10).n == Approx(4096));
  CHECK_FALSE(to_tolerance(curve, 0x1p-10).seconds);
  CHECK_FALSE(to_tolerance(curve, 0x1p-10).reason.empty());
}

TEST_CASE("the crossover is where a curve goes below for good", "[unit][estimate]") {
  using Pairs = std::vector<BesideRandom>;
  CHECK(crossover(Pairs{{1, 2, 1}, {2, 0.5, 1}, {4, 2, 1}, {8, 0.5, 1}, {16, 0.5, 1}}) == 8U);
  CHECK(crossover(Pairs{{16, 0.5, 1}, {1, 0.5, 1}, {4, 0.5, 1}}) == 1U);  // any order
  CHECK_FALSE(crossover(Pairs{{1, 0.5, 1}, {2, 1, 1}}));
  CHECK_FALSE(crossover(Pairs{}));
}

}  // namespace koksma
