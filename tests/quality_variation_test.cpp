// Hardy-Krause variations against differences on fine grids, and the Koksma-Hlawka inequality.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "catalog/embedded.hpp"
#include "estimate/exact_sum.hpp"
#include "quality/star.hpp"
#include "tests/quality_support.hpp"

using namespace koksma;
using test::drawn;
using test::quality_kernels;

namespace {

// The integrand at any points, 1 included, which no sampler draws: a program whose points_next
// reads the coordinates from a buffer.
std::vector<double> values_at(const Integrand& f, const Scene& scene, const PointSet& x) {
  std::string text = fmt::format(
      "#define KOKSMA_LANES_PER_ITEM 1\n#define KOKSMA_FP64 1\n#define KOKSMA_DIM {}\n"
      "#define KOKSMA_CENTRED 0\n{}\n"
      "typedef struct {{ __global const scalar *x; }} points;\n"
      "static inline real points_next(points *p) {{ return *p->x++; }}\n{}\ntypedef struct {{ "
      "scalar unused",
      x.dim, embedded_text("kernels/prelude.cl"), embedded_text("kernels/centred.cl"));
  std::string loads;
  for (std::size_t i = 0; i < f.parameters.size(); ++i) {
    text += ", " + f.parameters[i].name;
    loads += fmt::format("  q.{} = v[{}];\n", f.parameters[i].name, i);
  }
  text += fmt::format(
      "; }} params;\n{}\n"
      "__kernel void values(__global const scalar *x, __global const scalar *v, coefficients c, "
      "__global scalar *out) {{\n  const uint i = get_global_id(0);\n  points p = {{x + i * {}}};\n"
      "  params q;\n{}  out[i] = integrand(&p, q, c);\n}}\n",
      source_text(f), x.dim, loads);
  Device& device = test::device();
  const ExactValues exact = compute_exact(device, f, scene);
  cl::Kernel kernel(device.build({f.name, text, "-cl-std=CL1.2 -w"}).program, "values");
  const cl::Buffer points = device.upload_reals(x.x, true);
  const cl::Buffer parameters = device.upload_reals(scene.parameters, true);
  const cl::Buffer coefficients = device.upload_reals(exact.coefficients, true);
  std::vector<double> result(x.size());
  const cl::Buffer out = device.allocate(result.size() * sizeof(double));
  cl_uint index = 0;
  for (const cl::Buffer& buffer : {points, parameters, coefficients, out})
    kernel.setArg(index++, buffer);
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(result.size()),
                                      cl::NDRange(1));
  device.queue().enqueueReadBuffer(out, CL_TRUE, 0, result.size() * sizeof(double), result.data());
  return result;
}

// Node i of m intervals. Points lie in [0,1), so a value at 1 is the limit from below.
double node(std::uint32_t i, std::uint32_t m) {
  return std::min(static_cast<double>(i) / m, 1 - 0x1p-53);
}

// Sum of |f(x_i+1) - f(x_i)| on m intervals.
double grid_variation_1d(const Integrand& f, const Scene& scene, std::uint32_t m) {
  PointSet grid{1, {}};
  for (std::uint32_t i = 0; i <= m; ++i) grid.x.push_back(node(i, m));
  const std::vector<double> y = values_at(f, scene, grid);
  double sum = 0;
  for (std::uint32_t i = 0; i < m; ++i) sum += std::fabs(y[i + 1] - y[i]);
  return sum;
}

// Vitali variations of the square and of its faces x = 1 and y = 1 on m x m cells.
double grid_variation_2d(const Integrand& f, const Scene& scene, std::uint32_t m) {
  PointSet grid{2, {}};
  for (std::uint32_t i = 0; i <= m; ++i)
    for (std::uint32_t k = 0; k <= m; ++k) {
      grid.x.push_back(node(i, m));
      grid.x.push_back(node(k, m));
    }
  const std::vector<double> y = values_at(f, scene, grid);
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return y[i * (m + 1) + k]; };
  double sum = 0;
  for (std::uint32_t i = 0; i < m; ++i) {
    sum += std::fabs(at(i + 1, m) - at(i, m)) + std::fabs(at(m, i + 1) - at(m, i));
    for (std::uint32_t k = 0; k < m; ++k)
      sum += std::fabs(at(i + 1, k + 1) - at(i + 1, k) - at(i, k + 1) + at(i, k));
  }
  return sum;
}

std::vector<const Integrand*> with_variation() {
  std::vector<const Integrand*> found;
  for (const Integrand& f : test::catalog().integrands)
    if (f.variation.kind == ExactSource::Kind::formula) found.push_back(&f);
  return found;
}

}  // namespace

TEST_CASE(
    "closed forms of the Hardy-Krause variation agree with differences on fine grids, from above",
    "[device]") {
  REQUIRE(with_variation().size() >= 7);
  for (const Integrand* f : with_variation())
    for (const std::uint32_t d : {1U, 2U}) {
      if (d < f->min_dim || d > f->max_dim) continue;
      const Scene scene = parse_scene(test::catalog(), fmt::format("{}:d={}", f->name, d), "test");
      const double exact = compute_exact(test::device(), *f, scene).variation.value();
      const double grid =
          d == 1 ? grid_variation_1d(*f, scene, 1 << 14) : grid_variation_2d(*f, scene, 512);
      INFO(scene.text << ": closed form " << exact << ", grid " << grid);
      CHECK(grid <= exact * (1 + 1e-9));
      CHECK(grid >= exact * (d == 1 ? 0.999 : 0.98));
    }
}

TEST_CASE("a discontinuity counts up and down, and not where the cut is at 1", "[device]") {
  const Integrand& f = test::catalog().integrand("genz-discontinuous", "test");
  const auto variation = [&](const char* text) {
    return *compute_exact(test::device(), f, parse_scene(test::catalog(), text, "test")).variation;
  };
  CHECK(variation("genz-discontinuous:d=1,h=1,u1=1/2") == Approx(2 * std::exp(0.5) - 1));
  CHECK(variation("genz-discontinuous:d=1,h=1,u1=1") == Approx(std::exp(1.0) - 1));
}

TEST_CASE("undefined parameters have no variation", "[device]") {
  const Scene scene = parse_scene(test::catalog(), "sobol-g:d=2,scale=0,offset=-1", "test");
  CHECK_FALSE(
      compute_exact(test::device(), test::catalog().integrand("sobol-g", "test"), scene).variation);
}

TEST_CASE("Koksma-Hlawka: the error is at most variation times star discrepancy", "[device]") {
  std::size_t tight = 0;
  for (const char* sampler : {"sobol", "sobol-owen", "lattice", "random"})
    for (const std::uint64_t n : {16U, 300U}) {
      const PointSet points = drawn(sampler, n, 2);
      const double star = star_exact(quality_kernels(), points);
      for (const Integrand* f : with_variation()) {
        if (f->max_dim < 2) continue;
        const Scene scene = parse_scene(test::catalog(), f->name + ":d=2", "test");
        const ExactValues exact = compute_exact(test::device(), *f, scene);
        ExactSum sum;
        sum.add(values_at(*f, scene, points));
        const double error = std::fabs(sum.rounded_quotient(n) - *exact.mean);
        INFO(sampler << ", N = " << n << ", " << scene.text << ": " << error
                     << " <= " << *exact.variation << " * " << star);
        CHECK(error <= *exact.variation * star);
        tight += error > 0.1 * *exact.variation * star;
      }
    }
  CHECK(tight > 0);  // a bound that is far off everywhere would prove nothing
}
