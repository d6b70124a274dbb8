// What tests of the counters share: patterns of bits, integrands and points that make them, and
// what the host counts of them.
#pragma once

#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "device/integrator.hpp"
#include "plan/compose.hpp"
#include "tests/support.hpp"

namespace koksma::test {

inline constexpr std::uint32_t kWidths[] = {1, 4, 8, 16};
inline constexpr std::size_t kPatterns = 16;

template <typename Word>
using PatternsOf = std::array<Word, kPatterns>;

// NaNs quiet and signalling with payloads, infinities, the ends of the denormals and of the
// normals, zeros, and values on both sides of the limit, in this order in both precisions.
inline constexpr PatternsOf<std::uint64_t> kPatterns64{
    0x7FF8000000000000, 0xFFF8000040012345, 0x7FF0000000000001, 0xFFF4000000000000,
    0x7FF0000000000000, 0xFFF0000000000000, 0x000FFFFFFFFFFFFF, 0x8000000000000001,
    0x0010000000000000, 0x0000000000000000, 0x8000000000000000, 0x3FF8000000000000,  // 1.5
    0x4085E00000000000, 0xC085E00000000001, 0x7FEFFFFFFFFFFFFF, 0xBFE0000000000000};
inline constexpr PatternsOf<std::uint64_t> kPatterns32{
    0x7FC00000, 0xFFC12345, 0x7F800001, 0xFFA00000, 0x7F800000, 0xFF800000, 0x007FFFFF, 0x80000001,
    0x00800000, 0x00000000, 0x80000000, 0x3FC00000, 0x442F0000, 0xC42F0001, 0x7F7FFFFF, 0xBF000000};
inline constexpr double kLimit = 700;  // 0x4085E00000000000, 0x442F0000

inline const PatternsOf<std::uint64_t>& patterns(Precision precision) {
  return precision == Precision::fp64 ? kPatterns64 : kPatterns32;
}

inline double value_of(std::uint64_t pattern, Precision precision) {
  return precision == Precision::fp64
             ? std::bit_cast<double>(pattern)
             : double{std::bit_cast<float>(static_cast<std::uint32_t>(pattern))};
}

// Code of `bits NAME(real x)`: pattern floor(count x) of the list, chosen without arithmetic on it.
inline std::string pattern_code(const std::string& name, const std::vector<std::uint64_t>& list64,
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

// Of one coordinate: `my-patterns`, whose values are the patterns, by floor(16 x), its parameter
// never used; `my-lonely-pattern`, which is pattern `kind` where x < 1/256, else 1.5 + 2^-22:
// the halves of fp64's number are both those of ordinary ones.
class PatternIntegrands {
 public:
  PatternIntegrands()
      : catalog_(load_catalog(
            {write("my-patterns", R"({"name": "tiny", "default": 1, "min": 0, "max": 1})",
                   "  return KOKSMA_AS_REAL(pattern(points_next(p)));\n"),
             write("my-lonely-pattern", R"({"name": "kind", "default": 0, "min": 0, "max": 15})",
                   R"(  const bits k = KOKSMA_TO_BITS(points_next(p) * R(256.0));
  const bits here = (k - 1) >> (word)(8 * sizeof(word) - 1);
  const bits odd = pattern((real)((q.kind + R(0.5)) * R(0.0625)));
  const bits usual = KOKSMA_AS_BITS((real)R(0x1.800004p0));
  return KOKSMA_AS_REAL((odd & ((word)0 - here)) | (usual & (here - (word)1)));
)")})) {}

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
    return make_plan(catalog_, c, device().facts(), "", options);
  }

 private:
  // The entry's path.
  std::string write(const std::string& name, const std::string& parameter,
                    const std::string& code) const {
    Json entry = Json::parse(R"({"title": "t", "citation": "c", "reference": [], "class": "smooth",
      "periodic": false, "dimensions": {"min": 1, "max": 1, "default": 1}, "draws": "d",
      "coefficients": [], "transforms": [], "exact_operations": true, "nonnegative": false,
      "exact": {"mean": {"from": "none"}}, "checks": []})");
    entry["name"] = name;
    entry["parameters"] = {Json::parse(parameter)};
    entry["parameters"][0]["meaning"] = "m";
    folder_.write(name + ".cl",
                  "#ifndef KOKSMA_EXACT\n" +
                      pattern_code("pattern", {kPatterns64.begin(), kPatterns64.end()},
                                   {kPatterns32.begin(), kPatterns32.end()}) +
                      "static inline real integrand(points *p, params q, coefficients c) {\n" +
                      code + "}\n#endif\n");
    return folder_.write(name + ".json", entry.dump());
  }

  TemporaryFolder folder_;
  Catalog catalog_;
};

inline const PatternIntegrands& own() {
  static const PatternIntegrands loaded;
  return loaded;
}

// What must be counted of these values by the host's own classification.
inline Counters expected_of(const std::vector<double>& values, Precision precision) {
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

inline void check_counts(const Counters& seen, const Counters& expected) {
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

inline std::vector<double> drawn_values(std::uint64_t n, std::uint32_t replicates,
                                        Precision precision) {
  std::vector<double> values;
  for (std::uint32_t r = 0; r < replicates; ++r)
    for (const double x : points(
             {.sampler = "random", .dim = 1, .precision = precision, .count = n, .replicate = r}))
      values.push_back(
          value_of(patterns(precision)[static_cast<std::size_t>(x * kPatterns)], precision));
  return values;
}

inline Counters count(const Plan& plan, double typical = 1) {
  Integrator integrator(device(), plan, {});
  integrator.count_against(kLimit, typical);
  integrator.run(plan.cell.n.back(), 0, [](auto, auto, auto) {});
  return integrator.counters();
}

inline std::string label(Precision precision, std::uint32_t lanes, std::uint64_t n) {
  return std::string(precision_name(precision)) + " lanes " + std::to_string(lanes) + " N " +
         std::to_string(n);
}

// The plan with its points broken, by code of `bits broken(real x)`.
inline Plan with_bad_coordinates(Plan plan, const std::string& broken) {
  // The whole text: pruning takes out what only the broken points need.
  plan.program = compose_whole(catalog(), plan, ProgramKind::integrate);
  std::string& text = plan.program.text;
  const std::string from = "return unit_from_mantissa(drawn_state(p, p->dim++));";
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(),
               "return KOKSMA_AS_REAL(broken(unit_from_mantissa(drawn_state(p, p->dim++))));");
  text.insert(text.find("static inline void points_seek"), broken);
  return plan;
}

}  // namespace koksma::test
