// Every integrand of the catalog: exact values against the verified references, device values
// against 25-digit ones, the declared number of draws, and the sampled mean against the exact one.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "estimate/measure.hpp"
#include "tests/integrand_batch.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

Scene scene_of(const Integrand& f, const Json& check) {
  return scene_of(f, check["d"], check["parameters"]);
}

// Relative to the value, absolute where it is 0.
double deviation(double computed, double expected) {
  return std::fabs(computed - expected) / (expected == 0 ? 1 : std::fabs(expected));
}

// An entry's value at a point, with what it should be.
struct SampleCheck {
  const Integrand* f;
  test::BatchItem item;
  double expected;
};

// All sample checks by dimension: a batch each. The point is that of all 16 lanes.
std::map<std::uint32_t, std::vector<SampleCheck>> sample_checks() {
  std::map<std::uint32_t, std::vector<SampleCheck>> result;
  for (const Integrand& f : test::catalog().integrands) {
    REQUIRE(!f.sample_checks.empty());
    for (const Json& check : f.sample_checks) {
      SampleCheck sample{&f, {scene_of(f, check), {}}, std::stod(check["f"].get<std::string>())};
      for (const double x : check["x"].get<std::vector<double>>()) {
        REQUIRE(static_cast<float>(x) == x);
        sample.item.x.insert(sample.item.x.end(), 16, x);
      }
      result[sample.item.scene.dim].push_back(std::move(sample));
    }
  }
  return result;
}

double ulp_of(double value, Precision precision) {
  if (precision == Precision::fp64)
    return std::nextafter(std::fabs(value), INFINITY) - std::fabs(value);
  const auto narrow = static_cast<float>(std::fabs(value));
  return std::nextafterf(narrow, INFINITY) - narrow;
}

}  // namespace

TEST_CASE("closed forms agree with all verified references to 1e-13, or as their entry states",
          "[device]") {
  std::size_t checked = 0;
  for (const Integrand& f : test::catalog().integrands) {
    INFO(f.name);
    REQUIRE(f.checks.empty() == (f.mean.kind == ExactSource::Kind::undefined));
    for (const Json& check : f.checks) {
      const ExactValues exact = compute_exact(test::device(), f, scene_of(f, check));
      INFO(f.name << " d = " << check["d"] << " " << check["parameters"]);
      REQUIRE(exact.mean);
      CHECK(deviation(*exact.mean, std::stod(check["mean"].get<std::string>())) <=
            f.mean.tolerance);
      CHECK(exact.infinite_variance == (check["variance"] == "inf"));
      if (check["variance"].is_string() && !exact.infinite_variance) {
        REQUIRE(exact.variance);
        CHECK(deviation(*exact.variance, std::stod(check["variance"].get<std::string>())) <=
              f.variance.tolerance);
      }
      ++checked;
    }
  }
  CHECK(checked >= 60);
}

TEST_CASE(
    "the device's value of every integrand at fixed points is within its entry's ulps (8) of the "
    "25-digit value, and it draws as many coordinates as its scene declares",
    "[device]") {
  for (const auto& [dim, checks] : sample_checks()) {
    std::vector<test::BatchItem> items;
    for (const SampleCheck& check : checks) items.push_back(check.item);
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      const auto values = test::evaluate(items, precision, 16);
      for (std::size_t k = 0; k < checks.size(); ++k) {
        const auto& [f, item, expected] = checks[k];
        const double ulps = precision == Precision::fp64 ? f->ulps_fp64 : f->ulps_fp32;
        INFO(item.scene.text << " " << f->name << " d = " << dim << " " << precision_name(precision)
                             << " at check " << k << ": " << values[k].f[5]);
        CHECK(values[k].drawn == dim);
        for (const double value : values[k].f)
          CHECK(std::fabs(value - expected) <= ulps * ulp_of(expected, precision));
      }
    }
  }
}

TEST_CASE("the sampled mean of every default scene meets its exact value", "[statistical]") {
  // 32 replicates of nested scrambling: |mean - I| <= 8 standard errors, false alarm below 1e-8 per
  // scene (Student t, 31 degrees of freedom).
  for (const Integrand& f : test::catalog().integrands) {
    Cell cell = test::cell(f.name, "sobol-owen", 1 << 12, 32);
    PreparedCell prepared(test::catalog(), test::device(), test::device(),
                          make_plan(test::catalog(), cell, test::device().facts()));
    if (prepared.exact().mean_undefined || prepared.exact().infinite_variance) {
      WARN(f.name << ": no mean or no variance, so no standard error to test with");
      continue;
    }
    const Row row = prepared.run_row(1 << 12);
    INFO(f.name << ": estimate " << *row.estimate.value << ", exact " << *prepared.exact().mean
                << ", standard error " << *row.estimate.standard_error);
    // Adaptive solvers stop at their default tolerance.
    const double rounding = f.ode_size > 0 ? 1e-8 : 1e-14;
    CHECK(std::fabs(*row.estimate.value - *prepared.exact().mean) <=
          8 * *row.estimate.standard_error + rounding * std::fabs(*prepared.exact().mean));
  }
}
