// L2 discrepancies, diaphony, minimum distance and net parameter against SciPy, definitions and
// known values.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "quality/discrepancy.hpp"
#include "quality/net.hpp"
#include "quality/quality.hpp"
#include "tests/quality_support.hpp"

using namespace koksma;
using test::drawn;
using test::lcg_points;
using test::quality_kernels;

namespace {

// F^2 = sum over integer frequencies h != 0 of |S(h)|^2 / prod max(1, |h_j|)^2, cut at |h_j| <=
// reach.
double diaphony2_by_frequencies(const PointSet& p, int reach) {
  REQUIRE(p.dim == 2);
  double sum = 0;
  for (int h = -reach; h <= reach; ++h)
    for (int k = -reach; k <= reach; ++k) {
      if (h == 0 && k == 0) continue;
      double re = 0, im = 0;
      for (std::uint64_t i = 0; i < p.size(); ++i) {
        const double phase = 2 * std::numbers::pi * (h * p.at(i, 0) + k * p.at(i, 1));
        re += std::cos(phase);
        im += std::sin(phase);
      }
      const double weight = std::max(1, std::abs(h)) * std::max(1, std::abs(k));
      sum += (re * re + im * im) / (weight * weight);
    }
  return sum / static_cast<double>(p.size() * p.size());
}

double toroidal_distance(const PointSet& p) {
  double least = INFINITY;
  for (std::uint64_t i = 0; i < p.size(); ++i)
    for (std::uint64_t k = 0; k < i; ++k) {
      double square = 0;
      for (std::uint32_t j = 0; j < p.dim; ++j) {
        const double gap = std::fabs(p.at(i, j) - p.at(k, j)), t = std::min(gap, 1 - gap);
        square += t * t;
      }
      least = std::min(least, square);
    }
  return std::sqrt(least);
}

std::uint32_t t_of(const PointSet& p) {
  const NetParameter net = net_parameter(quality_kernels(), p);
  INFO(net.reason);
  REQUIRE(net.t);
  return *net.t;
}

}  // namespace

TEST_CASE("discrepancies equal SciPy's for the same points to 1e-12, compared as squares",
          "[device]") {
  const Json reference =
      parse_json(test::repository_file("tests/quality_reference.json"), "quality_reference.json");
  REQUIRE(reference["sets"].size() >= 15);
  for (const Json& set : reference["sets"]) {
    const PointSet p = lcg_points(set["n"], set["d"], set["seed"], set["shift"]);
    INFO("n = " << set["n"] << ", d = " << set["d"] << ", shift = " << set["shift"]);
    REQUIRE(std::vector<double>(p.x.end() - p.dim, p.x.end()) ==
            set["last"].get<std::vector<double>>());
    const L2Discrepancies l2 = l2_discrepancies(quality_kernels(), p);
    const double l2star = set["l2star"];
    CHECK(std::fabs(l2.l2star2 - l2star * l2star) <= 1e-12);
    CHECK(std::fabs(l2.cd2 - set["cd2"].get<double>()) <= 1e-12);
    CHECK(std::fabs(l2.wd2 - set["wd2"].get<double>()) <= 1e-12);
    CHECK(std::fabs(l2.md2 - set["md2"].get<double>()) <= 1e-12);
  }
}

TEST_CASE("arithmetic in fp32 agrees with fp64 to its own precision", "[device]") {
  QualityKernels narrow(test::device(), false);
  const PointSet p = lcg_points(300, 3, 5);
  const L2Discrepancies a = l2_discrepancies(quality_kernels(), p), b = l2_discrepancies(narrow, p);
  CHECK(b.l2star2 == Approx(a.l2star2).margin(1e-6));
  CHECK(b.cd2 == Approx(a.cd2).margin(1e-5));
  CHECK(b.wd2 == Approx(a.wd2).margin(1e-5));
  CHECK(b.md2 == Approx(a.md2).margin(1e-5));
  CHECK(b.diaphony2 == Approx(a.diaphony2).margin(1e-4));
  CHECK(minimum_toroidal_distance(narrow, p) ==
        Approx(minimum_toroidal_distance(quality_kernels(), p)).epsilon(1e-5));
}

TEST_CASE("closed forms: one point at the centre, and the midpoints in one dimension", "[device]") {
  // L2-star^2 of {(1/2, ..., 1/2)}: 3^-d - 2 (3/8)^d + 2^-d; diaphony^2: (1 + pi^2 / 3)^d - 1.
  for (const std::uint32_t d : {1U, 2U, 5U}) {
    const L2Discrepancies l2 =
        l2_discrepancies(quality_kernels(), {d, std::vector<double>(d, 0.5)});
    CHECK(l2.l2star2 == Approx(std::pow(3.0, -int(d)) - 2 * std::pow(0.375, d) + std::pow(0.5, d)));
    CHECK(l2.diaphony2 ==
          Approx(std::pow(1 + std::numbers::pi * std::numbers::pi / 3, d) - 1).epsilon(1e-13));
  }
  // L2-star of the midpoint set is 1 / (sqrt(12) N) (Niederreiter 1992, section 2.1), its diaphony
  // pi / (sqrt(3) N).
  const std::uint64_t n = 50;
  PointSet midpoints{1, {}};
  for (std::uint64_t i = 0; i < n; ++i) midpoints.x.push_back((static_cast<double>(i) + 0.5) / n);
  const L2Discrepancies l2 = l2_discrepancies(quality_kernels(), midpoints);
  CHECK(std::sqrt(l2.l2star2) == Approx(1 / (std::sqrt(12.0) * n)).epsilon(1e-9));
  CHECK(std::sqrt(l2.diaphony2) == Approx(std::numbers::pi / (std::sqrt(3.0) * n)).epsilon(1e-9));
}

TEST_CASE("diaphony is the weighted sum of the squared Fourier coefficients", "[device]") {
  const PointSet p = lcg_points(20, 2, 3);
  // The tail beyond 150 is below 4 (1 + pi^2 / 3) / 150.
  const double cut = diaphony2_by_frequencies(p, 150);
  const double whole = l2_discrepancies(quality_kernels(), p).diaphony2;
  CHECK(whole > cut);
  CHECK(whole < cut + 0.03 * (1 + std::numbers::pi * std::numbers::pi / 3));
}

TEST_CASE("the minimum toroidal distance is the least over all pairs, across the edge too",
          "[device]") {
  for (const std::uint32_t d : {1U, 2U, 3U, 7U})
    for (const std::uint64_t n : {2U, 15U, 16U, 17U, 100U}) {
      const PointSet p = lcg_points(n, d, n + d);
      INFO("n = " << n << ", d = " << d);
      CHECK(minimum_toroidal_distance(quality_kernels(), p) ==
            Approx(toroidal_distance(p)).epsilon(1e-14));
    }
  CHECK(minimum_toroidal_distance(quality_kernels(), {2, {0.0625, 0.5, 0.9375, 0.5}}) == 0.125);
  CHECK(minimum_toroidal_distance(quality_kernels(), {2, {0.25, 0.5, 0.7, 0.1, 0.25, 0.5}}) == 0);
}

TEST_CASE("t of known nets: Sobol' 0 in d = 1, 2 and 1 in d = 3, Hammersley 0, equal points m",
          "[device]") {
  for (const std::uint32_t d : {1U, 2U})
    for (const std::uint64_t n : {1U, 2U, 64U, 4096U}) CHECK(t_of(drawn("sobol", n, d)) == 0);
  // The polynomials of dimensions 2 and 3 have degrees 1 and 2, so t <= 1 (Sobol' 1967); it is
  // reached, and nested scrambling keeps it.
  CHECK(t_of(drawn("sobol", 1024, 3)) == 1);
  CHECK(t_of(drawn("sobol-owen", 1024, 3)) <= 1);
  CHECK(t_of(drawn("sobol-owen", 1024, 2)) == 0);
  PointSet hammersley{2, {}};
  const PointSet first = drawn("sobol", 256, 1);
  // Gray-code order: point i of the sequence has index i ^ i / 2.
  for (std::uint64_t i = 0; i < 256; ++i) {
    hammersley.x.push_back(static_cast<double>(i ^ i >> 1) / 256);
    hammersley.x.push_back(first.x[i]);
  }
  CHECK(t_of(hammersley) == 0);
  CHECK(t_of({3, std::vector<double>(192, 0.5)}) == 6);
}

TEST_CASE("t is the least for which all intervals are full: one point moved spoils it",
          "[device]") {
  PointSet p = drawn("sobol", 64, 2);
  // Out of its interval of area 1/64 only: halves and quarters keep their shares.
  const NetParameter before = net_parameter(quality_kernels(), p);
  p.x[0] = 1.0 / 64;
  CHECK(before.t == 0U);
  CHECK(t_of(p) == 1);
}

TEST_CASE("t has a reason where there is none", "[device]") {
  const NetParameter odd = net_parameter(quality_kernels(), lcg_points(100, 2, 1));
  CHECK_FALSE(odd.t);
  CHECK_THAT(odd.reason, Catch::Contains("N = 100 is no power of two"));
}

TEST_CASE("what is too expensive is left out, and the reason names the limit", "[device]") {
  QualityLimits none;
  none.pair_terms = none.star_2d_n = none.search_visits = none.cover_visits = 1;
  none.spectrum_terms = none.histogram_pairs = 1;
  const Quality q = measure_quality(quality_kernels(), {lcg_points(64, 2, 1)}, none);
  for (const Measure& m : q.measures) {
    INFO(m.name << ": " << m.reason);
    CHECK(m.value.has_value() == (m.name == "t"));
    if (!m.value) CHECK_THAT(m.reason, Catch::StartsWith("too expensive: "));
  }
  CHECK_FALSE(q.power_spectrum);
  CHECK_THAT(q.power_spectrum_reason, Catch::Contains("the limit is 1"));
  CHECK_FALSE(q.pair_correlation);
  CHECK_THAT(q.pair_correlation_reason, Catch::Contains("the limit is 1"));
}
