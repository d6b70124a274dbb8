// Every integrand of the catalog: exact values against the verified references, device values
// against 25-digit ones, the declared number of draws, and the sampled mean against the exact one.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "estimate/measure.hpp"
#include "plan/compose.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

Scene scene_of(const Integrand& f, const Json& check) {
  Scene scene;
  scene.integrand = f.name;
  scene.dim = check["d"];
  for (const Parameter& p : f.parameters)
    scene.parameters.push_back(check["parameters"].value(p.name, p.default_value));
  return scene;
}

// Relative to the value, absolute where it is 0.
double deviation(double computed, double expected) {
  return std::fabs(computed - expected) / (expected == 0 ? 1 : std::fabs(expected));
}

// f(x) through the engine: a net whose columns are zero and whose start is x puts every sample on
// x.
double value_at(const Integrand& f, const Scene& scene, const std::vector<double>& x,
                Precision precision) {
  Cell cell = test::cell(f.name, "sobol", 16);
  cell.scene = scene;
  cell.precision = precision;
  const Plan plan = make_plan(test::catalog(), cell, test::device().facts());
  const ExactValues exact = compute_exact(test::device(), f, scene);
  std::vector<std::byte> table = build_point_table(plan);
  const std::size_t size = precision == Precision::fp64 ? 8 : 4;
  const std::size_t starts = table.size() / size - x.size();  // the last part of the table
  std::fill(table.begin() + static_cast<long>(8 * size),
            table.begin() + static_cast<long>(starts * size), std::byte{0});
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double shifted = 1 + x[j];
    const auto narrow = static_cast<float>(shifted);
    REQUIRE((precision == Precision::fp64 || narrow == shifted));
    std::memcpy(table.data() + (starts + j) * size,
                size == 8 ? static_cast<const void*>(&shifted) : &narrow, size);
  }
  return Integrator(test::device(), plan, exact.coefficients, table).first_values()[5];
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
    "25-digit value",
    "[device]") {
  for (const Integrand& f : test::catalog().integrands) {
    REQUIRE(!f.sample_checks.empty());
    for (const Json& check : f.sample_checks) {
      const double expected = std::stod(check["f"].get<std::string>());
      for (const Precision precision : {Precision::fp32, Precision::fp64}) {
        const double value =
            value_at(f, scene_of(f, check), check["x"].get<std::vector<double>>(), precision);
        const double ulp =
            precision == Precision::fp64
                ? std::nextafter(std::fabs(expected), INFINITY) - std::fabs(expected)
                : std::nextafterf(static_cast<float>(std::fabs(expected)), INFINITY) -
                      static_cast<float>(std::fabs(expected));
        INFO(f.name << " " << precision_name(precision) << " at " << check["x"] << ": " << value);
        CHECK(std::fabs(value - expected) <=
              (precision == Precision::fp64 ? f.ulps_fp64 : f.ulps_fp32) * ulp);
      }
    }
  }
}

TEST_CASE("every integrand draws as many coordinates as its scene declares", "[device]") {
  for (const Integrand& f : test::catalog().integrands) {
    Cell cell = test::cell(f.name, "sobol-shift", 256);
    Plan plan = make_plan(test::catalog(), cell, test::device().facts());
    const ExactValues exact = compute_exact(test::device(), f, cell.scene);
    Device& device = test::device();
    const auto table = build_point_table(plan);
    const cl::Buffer points = device.upload(table.data(), table.size());
    const cl::Buffer values =
        device.upload(cell.scene.parameters.data(), cell.scene.parameters.size() * 8);
    const cl::Buffer coefficients =
        device.upload(exact.coefficients.data(), exact.coefficients.size() * 8);
    const cl::Buffer out = device.allocate(4);
    cl::Kernel kernel(device.build(inspect_program(test::catalog(), plan, true)).program,
                      "dump_draws");
    kernel.setArg(0, points);
    kernel.setArg(1, values);
    kernel.setArg(2, coefficients);
    kernel.setArg(3, cl_ulong{256});
    kernel.setArg(4, cl_ulong{1});
    kernel.setArg(5, out);
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    cl_uint drawn = 0;
    device.queue().enqueueReadBuffer(out, CL_TRUE, 0, sizeof(drawn), &drawn);
    INFO(f.name);
    CHECK(drawn == cell.scene.dim);
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
    CHECK(std::fabs(*row.estimate.value - *prepared.exact().mean) <=
          8 * *row.estimate.standard_error + 1e-14 * std::fabs(*prepared.exact().mean));
  }
}
