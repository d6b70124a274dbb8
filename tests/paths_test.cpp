// Paths of Brownian motion by increments, bridge and principal components: one law, told from the
// coefficients of the constructions, and smaller errors where few dimensions carry the variance.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "estimate/measure.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

const std::vector<std::string> kGeometricCalls{
    "asian-geometric-call", "asian-geometric-call-bridge", "asian-geometric-call-pca"};
const std::vector<std::string> kArithmeticForwards{
    "asian-arith-forward", "asian-arith-forward-bridge", "asian-arith-forward-pca"};

constexpr double kSigma = 0.2, kTime = 1;  // defaults of the scenes

ExactValues exact_of(const std::string& name, std::uint32_t dim) {
  const Cell cell = test::cell(fmt::format("{}:d={}", name, dim), "random", 16);
  return compute_exact(test::device(), test::catalog().integrand(name, "test"), cell.scene);
}

using Matrix = std::vector<std::vector<double>>;  // [draw or time][normal]

// Log prices of the depth-first bridge, by draw, from its coefficients left, right, deviation,
// slots, scale.
Matrix bridge_paths(const std::vector<double>& c, std::uint32_t dim) {
  Matrix slots(16, std::vector<double>(dim)), paths;
  for (std::size_t k = 0; k < dim; ++k) {
    const auto at = static_cast<std::size_t>(c[5 * k + 3]);
    const std::vector<double>&left = slots.at(at & 15), &right = slots.at(at >> 4 & 15);
    std::vector<double> path(dim);
    for (std::size_t j = 0; j < dim; ++j)
      path[j] = c[5 * k] * left[j] + (k == 0 ? 0 : c[5 * k + 1] * right[j]);
    path[k] += c[5 * k + 2];
    slots.at(at >> 8) = path;
    paths.push_back(path);
  }
  return paths;
}

// Log prices by principal components, by time, from its table.
Matrix component_paths(const std::vector<double>& table, std::uint32_t dim) {
  const std::size_t period = 4 * std::size_t{dim} + 2;
  Matrix paths(dim, std::vector<double>(dim));
  for (std::size_t i = 0; i < dim; ++i)
    for (std::size_t j = 0; j < dim; ++j)
      paths[i][j] = table[(2 * j + 1) * (i + 1) % period] * table[period + j];
  return paths;
}

// Whether the log prices have the covariances sigma^2 min(t_i, t_l), each time once.
void check_covariances(const Matrix& paths, std::uint32_t dim) {
  const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  const double unit = kSigma * kSigma * kTime / dim;
  std::vector<double> times, expected(dim);
  for (const auto& path : paths) times.push_back(std::round(product(path, path) / unit));
  for (std::size_t i = 0; i < dim; ++i)
    for (std::size_t l = 0; l <= i; ++l)
      CHECK(product(paths[i], paths[l]) ==
            Approx(unit * std::min(times[i], times[l])).epsilon(1e-12).margin(1e-15));
  std::sort(times.begin(), times.end());
  std::iota(expected.begin(), expected.end(), 1.0);
  CHECK(times == expected);
}

Row row_of(const std::string& name, std::uint32_t dim, std::uint64_t n, std::uint32_t replicates) {
  const Cell cell = test::cell(fmt::format("{}:d={}", name, dim), "sobol-owen", n, replicates);
  PreparedCell prepared(test::catalog(), test::device(), test::device(),
                        make_plan(test::catalog(), cell, test::device().facts()));
  return prepared.run_row(n);
}

}  // namespace

TEST_CASE("the constructions of a path have the same exact values at every dimension", "[device]") {
  for (const auto& names : {kGeometricCalls, kArithmeticForwards}) {
    for (const std::uint32_t dim : {1U, 2U, 3U, 7U, 64U, 100U, 128U, 1024U}) {
      const ExactValues reference = exact_of(names.front(), dim);
      for (const std::string& name : names) {
        if (dim > test::catalog().integrand(name, "test").max_dim) continue;
        const ExactValues exact = exact_of(name, dim);
        INFO(name << " d = " << dim);
        CHECK(*exact.mean == Approx(*reference.mean).epsilon(1e-14));
        CHECK(*exact.variance == Approx(*reference.variance).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("the weights of the geometric mean have the squares' sum that its law says", "[device]") {
  for (const std::string& name : kGeometricCalls) {
    for (const std::uint32_t dim :
         {1U, 2U, 3U, 5U, 6U, 7U, 9U, 31U, 32U, 33U, 100U, 1000U, 1024U}) {
      const std::vector<double> c = exact_of(name, dim).coefficients;
      double squares = 0;
      for (std::size_t j = 0; j < dim; ++j) squares += c[3 * j] * c[3 * j];
      const double d = dim;
      INFO(name << " d = " << dim);
      CHECK(squares ==
            Approx(kSigma * kSigma * kTime * (d + 1) * (2 * d + 1) / (6 * d * d)).epsilon(1e-13));
    }
  }
}

TEST_CASE("bridge and principal components give the covariance of Brownian motion", "[device]") {
  std::vector<std::uint32_t> dims(36);
  std::iota(dims.begin(), dims.end(), 1U);
  dims.insert(dims.end(), {63, 64, 65, 100, 128});
  for (const std::uint32_t dim : dims) {
    INFO("d = " << dim);
    check_covariances(bridge_paths(exact_of("asian-arith-forward-bridge", dim).coefficients, dim),
                      dim);
    check_covariances(component_paths(exact_of("asian-arith-forward-pca", dim).coefficients, dim),
                      dim);
  }
}

TEST_CASE("the depth-first bridge gives its points the dimensions of the order by levels",
          "[device]") {
  for (const std::uint32_t dim : {1U, 2U, 3U, 5U, 6U, 7U, 13U, 64U, 65U, 100U, 1023U, 1024U}) {
    const ExactValues exact = exact_of("asian-arith-forward-bridge", dim);
    INFO("d = " << dim);
    REQUIRE(exact.dimension_order.size() == dim);
    CHECK(exact.dimension_order.front() == 0);
    // Level of the point that each dimension belongs to; the end is level 0.
    std::vector<std::uint32_t> levels(dim, 99);
    for (std::size_t k = 0; k < dim; ++k)
      levels.at(exact.dimension_order[k]) =
          static_cast<std::uint32_t>(exact.coefficients[5 * k + 3]) >> 8;
    CHECK(std::is_sorted(levels.begin(), levels.end()));
    CHECK(levels.back() == (dim == 1 ? 0 : std::bit_width(dim - 1)));
    auto order = exact.dimension_order;
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < dim; ++k) REQUIRE(order[k] == k);
  }
}

TEST_CASE("constructions agree in the mean, and bridge and components have the smaller errors",
          "[statistical]") {
  // 128 replicates of N = 2^14: log RMSE has a standard deviation of 0.06, a ratio's of 0.09.
  // Measured ratios to the increments at d = 64: geometric call 8 (bridge), 34 (components);
  // forward 2.5 to 2.8. The bounds lie 6 standard deviations below or more, means within 8 standard
  // errors (false alarm below 1e-6).
  struct Bound {
    const std::vector<std::string>& names;
    double bridge, components;
  };
  for (const Bound& bound : {Bound{kGeometricCalls, 4, 15}, Bound{kArithmeticForwards, 1.5, 1.5}}) {
    std::vector<Row> rows;
    for (const std::string& name : bound.names) rows.push_back(row_of(name, 64, 1 << 14, 128));
    const double exact = *exact_of(bound.names.front(), 64).mean;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      INFO(bound.names[i] << ": RMSE ratio " << *rows[0].errors.rmse / *rows[i].errors.rmse);
      CHECK(std::fabs(*rows[i].estimate.value - exact) <= 8 * *rows[i].estimate.standard_error);
      CHECK(*rows[0].errors.rmse >= (i == 0   ? 1
                                     : i == 1 ? bound.bridge
                                              : bound.components) *
                                        *rows[i].errors.rmse);
    }
  }
}
