// What the kernel counts of its samples is what their bits are: at every width and precision, for
// any N and launch split, under relaxed math too.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "device/integrator.hpp"
#include "plan/compose.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;

namespace {

constexpr std::uint32_t kWidths[] = {1, 4, 8, 16};
constexpr std::size_t kPatterns = 16;

template <typename Word>
using PatternsOf = std::array<Word, kPatterns>;

// NaNs quiet and signalling with payloads, infinities, the ends of the denormals and of the
// normals, zeros, and values on both sides of the limit, in this order in both precisions.
constexpr PatternsOf<std::uint64_t> kPatterns64{
    0x7FF8000000000000, 0xFFF8000000012345, 0x7FF0000000000001, 0xFFF4000000000000,
    0x7FF0000000000000, 0xFFF0000000000000, 0x000FFFFFFFFFFFFF, 0x8000000000000001,
    0x0010000000000000, 0x0000000000000000, 0x8000000000000000, 0x3FF8000000000000,  // 1.5
    0x4085E00000000000, 0xC085E00000000001, 0x7FEFFFFFFFFFFFFF, 0xBFE0000000000000};
constexpr PatternsOf<std::uint64_t> kPatterns32{
    0x7FC00000, 0xFFC12345, 0x7F800001, 0xFFA00000, 0x7F800000, 0xFF800000, 0x007FFFFF, 0x80000001,
    0x00800000, 0x00000000, 0x80000000, 0x3FC00000, 0x442F0000, 0xC42F0001, 0x7F7FFFFF, 0xBF000000};
constexpr double kLimit = 700;  // 0x4085E00000000000, 0x442F0000

const PatternsOf<std::uint64_t>& patterns(Precision precision) {
  return precision == Precision::fp64 ? kPatterns64 : kPatterns32;
}

double value_of(std::uint64_t pattern, Precision precision) {
  return precision == Precision::fp64
             ? std::bit_cast<double>(pattern)
             : double{std::bit_cast<float>(static_cast<std::uint32_t>(pattern))};
}

// Code of `bits NAME(real x)`: pattern floor(count x) of the list, chosen without arithmetic on it.
std::string pattern_code(const std::string& name, const std::vector<std::uint64_t>& list64,
                         const std::vector<std::uint64_t>& list32) {
  std::string code = "static inline bits " + name +
                     "(real x) {\n  const bits k = KOKSMA_TO_BITS(x * R(" +
                     std::to_string(list64.size()) + ".0));\n  bits y = (bits)(word)0, e;\n";
  const auto choose = [&](const std::vector<std::uint64_t>& list) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string index = "(word)" + std::to_string(i);
      code += "  e = (k - " + index + ") | (" + index +
              " - k);\n"  // the top bit where k is not i
              "  y |= (bits)(word)" +
              std::to_string(list[i]) + "UL & ((e >> (word)(8 * sizeof(word) - 1)) - (word)1);\n";
    }
  };
  code += "#if KOKSMA_FP64\n";
  choose(list64);
  code += "#else\n";
  choose(list32);
  return code + "#endif\n  return y;\n}\n";
}

// An integrand of one coordinate whose values are the patterns, by floor(16 x); its parameter is
// never used.
class PatternIntegrand {
 public:
  PatternIntegrand()
      : catalog_(load_catalog({(write_code(), folder_.write("my-patterns.json", R"({
          "name": "my-patterns", "title": "t", "citation": "c", "reference": [], "class": "smooth",
          "periodic": false,
          "parameters": [{"name": "tiny", "default": 1, "min": 0, "max": 1, "meaning": "m"}],
          "dimensions": {"min": 1, "max": 1, "default": 1}, "draws": "d", "coefficients": [],
          "transforms": [], "exact_operations": true, "nonnegative": false,
          "exact": {"mean": {"from": "none"}}, "checks": []})"))})) {}

  const Catalog& catalog() const { return catalog_; }

  Plan plan(std::uint64_t n, std::uint32_t replicates, Precision precision,
            const LaunchShape& shape, bool relaxed = false,
            const std::string& scene = "my-patterns", bool counters = true,
            const std::string& sampler = "random") const {
    Cell c = cell("linear-prod:d=1", sampler, n, replicates);
    c.scene = parse_scene(catalog_, scene, "test");
    c.precision = precision;
    PlanOptions options{shape};
    options.relaxed_math = relaxed;
    options.counters = counters;
    return make_plan(catalog_, c, test::device().facts(), "", options);
  }

 private:
  void write_code() const {
    folder_.write("my-patterns.cl",
                  "#ifndef KOKSMA_EXACT\n" +
                      pattern_code("pattern", {kPatterns64.begin(), kPatterns64.end()},
                                   {kPatterns32.begin(), kPatterns32.end()}) +
                      "static inline real integrand(points *p, params q, coefficients c) {\n"
                      "  return KOKSMA_AS_REAL(pattern(points_next(p)));\n}\n#endif\n");
  }

  test::TemporaryFolder folder_;
  Catalog catalog_;
};

const PatternIntegrand& own() {
  static const PatternIntegrand loaded;
  return loaded;
}

// What must be counted of these values by the host's own classification.
Counters expected_of(const std::vector<double>& values, Precision precision) {
  Counters k;
  const double least = precision == Precision::fp64 ? std::numeric_limits<double>::min()
                                                    : double{std::numeric_limits<float>::min()};
  for (const double f : values) {
    ++k.samples;
    k.nan += std::isnan(f) ? 1 : 0;
    k.plus_inf += f == INFINITY ? 1 : 0;
    k.minus_inf += f == -INFINITY ? 1 : 0;
    k.denorm_out += f != 0 && std::fabs(f) < least ? 1 : 0;
    k.hits += f == 0 ? 0 : 1;
    k.blow_ups += std::fabs(f) > kLimit ? 1 : 0;
    if (!std::isfinite(f)) continue;
    k.max_abs = std::max(k.max_abs, std::fabs(f));
    k.sum_abs += std::fabs(f) / k.unit;
  }
  return k;
}

void check_counts(const Counters& seen, const Counters& expected) {
  CHECK(seen.samples == expected.samples);
  CHECK(seen.nan == expected.nan);
  CHECK(seen.plus_inf == expected.plus_inf);
  CHECK(seen.minus_inf == expected.minus_inf);
  CHECK(seen.denorm_out == expected.denorm_out);
  CHECK(seen.denorm_in == expected.denorm_in);
  CHECK(seen.coord_le0 == expected.coord_le0);
  CHECK(seen.coord_ge1 == expected.coord_ge1);
  CHECK(seen.hits == expected.hits);
  CHECK(seen.blow_ups == expected.blow_ups);
  CHECK(seen.max_abs == expected.max_abs);
}

std::vector<double> drawn_values(std::uint64_t n, std::uint32_t replicates, Precision precision) {
  std::vector<double> values;
  for (std::uint32_t r = 0; r < replicates; ++r)
    for (const double x : test::points(
             {.sampler = "random", .dim = 1, .precision = precision, .count = n, .replicate = r}))
      values.push_back(
          value_of(patterns(precision)[static_cast<std::size_t>(x * kPatterns)], precision));
  return values;
}

Counters count(const Plan& plan, double typical = 1) {
  Integrator integrator(test::device(), plan, {});
  integrator.count_against(kLimit, typical);
  integrator.run(plan.cell.n.back(), 0, [](auto, auto, auto) {});
  return integrator.counters();
}

std::string label(Precision precision, std::uint32_t lanes, std::uint64_t n) {
  return std::string(precision_name(precision)) + " lanes " + std::to_string(lanes) + " N " +
         std::to_string(n);
}

}  // namespace

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

// The plan with its points broken.
Plan with_bad_coordinates(Plan plan) {
  std::vector<std::uint64_t> list64, list32;
  for (const BadCoordinate& one : kCoordinates) {
    list64.push_back(one.bits64);
    list32.push_back(one.bits32);
  }
  // The whole text: pruning takes out what only the broken points need.
  plan.program = compose_whole(test::catalog(), plan, ProgramKind::integrate);
  std::string& text = plan.program.text;
  const std::string from = "return unit_from_mantissa(drawn_state(p, p->dim++));";
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(),
               "return KOKSMA_AS_REAL(broken(unit_from_mantissa(drawn_state(p, p->dim++))));");
  text.insert(text.find("static inline void points_seek"), pattern_code("broken", list64, list32));
  return plan;
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
              make_plan(test::catalog(), c, test::device().facts(), "", options));
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
