// What the kernel counts of its samples is what their bits are: at every width and precision, for
// any N and launch split, under relaxed math too.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/counters_support.hpp"

using namespace koksma;
using namespace koksma::test;

TEST_CASE("values are counted by their bits, at every width and precision, relaxed or not",
          "[device]") {
  for (const Precision precision : test::kPrecisions) {
    for (const std::uint64_t n : {1ULL, 3ULL, 37ULL, 255ULL, 1001ULL}) {
      const Counters expected = expected_of(drawn_values(n, 5, precision), precision);
      if (n == 1001) {
        // Every kind is there.
        CHECK((expected.nan > 900 && expected.plus_inf > 200 && expected.minus_inf > 200));
        CHECK((expected.denorm_out > 400 && expected.samples - expected.hits > 400));
        CHECK(expected.blow_ups > expected.plus_inf + expected.minus_inf + 400);
      }
      for (const std::uint32_t lanes : kWidths) {
        for (const bool relaxed : {false, true}) {
          INFO(label(precision, lanes, n) << (relaxed ? " relaxed" : ""));
          check_counts(count(own().plan(n, 5, precision, {lanes, 1, {}, {}}, relaxed)), expected);
        }
      }
    }
  }
}

TEST_CASE("counters are the same for every launch split, and the counts for every shape",
          "[device]") {
  constexpr std::uint64_t n = 4099;
  for (const Precision precision : test::kPrecisions) {
    const Counters whole = count(own().plan(n, 5, precision, {16, 1, {}, {}}));
    check_counts(whole, expected_of(drawn_values(n, 5, precision), precision));
    for (const std::uint64_t items : {1ULL, 4ULL, 7ULL, 33ULL}) {
      const Counters split = count(own().plan(n, 5, precision, {16, 1, {}, items}));
      INFO(precision_name(precision) << " items " << items);
      check_counts(split, whole);
      CHECK(split.sum_abs == whole.sum_abs);
      CHECK(split.sum_squares == whole.sum_squares);
    }
    for (const std::uint32_t block : {4U, 12U})
      check_counts(count(own().plan(n, 5, precision, {8, 1, block, {}})), whole);
  }
}

TEST_CASE("sums of sizes take the finite values, in a unit in which squares stay numbers",
          "[device]") {
  // The largest number dominates: in the unit 1 its square overflows and nothing is said of n_eff.
  constexpr std::uint64_t n = 1001;
  const double huge = std::numeric_limits<double>::max();
  const Counters plain = count(own().plan(n, 1, Precision::fp64, {16, 1, {}, {}}));
  CHECK_FALSE(plain.n_eff());
  const Counters scaled = count(own().plan(n, 1, Precision::fp64, {16, 1, {}, {}}), huge);
  CHECK(scaled.unit == 0x1p1022);
  double sum = 0, squares = 0;
  for (const double f : drawn_values(n, 1, Precision::fp64)) {
    if (!std::isfinite(f)) continue;
    sum += std::fabs(f) * 0x1p-1022;
    squares += (f * 0x1p-1022) * (f * 0x1p-1022);
  }
  CHECK(scaled.sum_abs == Approx(sum).epsilon(1e-13));
  CHECK(scaled.sum_squares == Approx(squares).epsilon(1e-13));
  // fp32 samples are squared in fp64.
  const Counters narrow = count(own().plan(n, 1, Precision::fp32, {16, 1, {}, {}}));
  sum = squares = 0;
  for (const double f : drawn_values(n, 1, Precision::fp32)) {
    if (!std::isfinite(f)) continue;
    sum += std::fabs(f);
    squares += f * f;
  }
  CHECK(narrow.sum_abs == Approx(sum).epsilon(1e-13));
  CHECK(narrow.sum_squares == Approx(squares).epsilon(1e-13));
}

TEST_CASE("denormal parameters are those that the kernel's precision holds as such", "[device]") {
  const auto denormals = [](const std::string& value, Precision precision) {
    return count(own().plan(16, 1, precision, {16, 1, {}, {}}, false, "my-patterns:tiny=" + value))
        .denorm_in;
  };
  CHECK(denormals("1e-40", Precision::fp32) == 1);
  CHECK(denormals("1e-40", Precision::fp64) == 0);
  CHECK(denormals("1e-310", Precision::fp32) == 0);  // 0 there
  CHECK(denormals("1e-310", Precision::fp64) == 1);
  CHECK(denormals("0", Precision::fp64) == 0);
}

namespace {

// Coordinates that no family hands out: by floor(8 x) of the exact one, with what must be said of
// them.
struct BadCoordinate {
  std::uint64_t bits64, bits32;
  bool le0, ge1;
};
constexpr std::array<BadCoordinate, 8> kCoordinates{{
    {0x0000000000000000, 0x00000000, true, false},   // 0
    {0x8000000000000000, 0x80000000, true, false},   // -0
    {0xBFF8000000000000, 0xBFC00000, true, false},   // -1.5
    {0x3FF0000000000000, 0x3F800000, false, true},   // 1
    {0x3FEFFFFFFFFFFFFF, 0x3F7FFFFF, false, false},  // the number before it
    {0xFFF8000000000000, 0xFFC00000, false, true},   // NaN of either sign
    {0x7FF8000000000000, 0x7FC00000, false, true},
    {0x0000000000000001, 0x00000001, false, false},  // above 0, if barely
}};

std::string bad_coordinates() {
  std::vector<std::uint64_t> list64, list32;
  for (const BadCoordinate& one : kCoordinates) {
    list64.push_back(one.bits64);
    list32.push_back(one.bits32);
  }
  return pattern_code("broken", list64, list32);
}

}  // namespace

TEST_CASE("samples with a coordinate outside (0,1) are counted once, whatever the others are",
          "[device]") {
  for (const Precision precision : test::kPrecisions) {
    for (const std::uint64_t n : {7ULL, 999ULL, 1024ULL}) {
      const auto x =
          test::points({.sampler = "sobol", .dim = 2, .precision = precision, .count = n});
      std::uint64_t le0 = 0, ge1 = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const auto& a = kCoordinates[static_cast<std::size_t>(x[2 * i] * 8)];
        const auto& b = kCoordinates[static_cast<std::size_t>(x[2 * i + 1] * 8)];
        le0 += a.le0 || b.le0 ? 1 : 0;
        ge1 += a.ge1 || b.ge1 ? 1 : 0;
      }
      // Of 64 pairs, 39 have one of the three.
      if (n == 1024) CHECK((le0 == 624 && ge1 == 624));  // 39 x 16
      for (const std::uint32_t lanes : kWidths) {
        for (const bool relaxed : {false, true}) {
          Cell c = cell("prod-2x:d=2", "sobol", n);
          c.precision = precision;
          PlanOptions options{LaunchShape{lanes, 1, {}, 3}};
          options.counters = true;
          options.relaxed_math = relaxed;
          const Plan plan = with_bad_coordinates(
              make_plan(test::catalog(), c, test::device().facts(), "", options),
              bad_coordinates());
          const ExactValues exact = compute_exact(test::device(), *plan.integrand, c.scene);
          Integrator integrator(test::device(), plan, exact.coefficients);
          integrator.run(n, 0, [](auto, auto, auto) {});
          INFO(label(precision, lanes, n) << (relaxed ? " relaxed" : ""));
          CHECK(integrator.counters().coord_le0 == le0);
          CHECK(integrator.counters().coord_ge1 == ge1);
        }
      }
    }
  }
}

TEST_CASE("a limit that the precision can not hold is the nearest normal number that it can",
          "[device]") {
  const auto blow_ups = [](double limit, Precision precision) {
    const Plan plan = own().plan(1001, 1, precision, {16, 1, {}, {}});
    Integrator integrator(test::device(), plan, {});
    integrator.count_against(limit, 1);
    integrator.run(1001, 0, [](auto, auto, auto) {});
    return integrator.counters();
  };
  for (const Precision precision : test::kPrecisions) {
    const Counters none = blow_ups(INFINITY, precision);
    CHECK(none.blow_ups == none.plus_inf + none.minus_inf);
    const double least = precision == Precision::fp64 ? std::numeric_limits<double>::min()
                                                      : double{std::numeric_limits<float>::min()};
    std::uint64_t above = 0;
    for (const double f : drawn_values(1001, 1, precision)) above += std::fabs(f) > least ? 1 : 0;
    CHECK(blow_ups(0, precision).blow_ups == above);
  }
}
