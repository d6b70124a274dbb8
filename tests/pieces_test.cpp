// Every kernel piece builds and agrees at widths 1, 4, 8, 16 in fp32 and fp64.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "tests/integrand_batch.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

bool same_value(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

// Sixteen points, with corners among them, exact in fp32.
std::vector<double> some_points(std::uint32_t dim) {
  std::vector<double> x;
  for (std::uint32_t j = 0; j < dim; ++j)
    for (std::uint32_t i = 0; i < 16; ++i)
      x.push_back(i == 0   ? 0x1p-24
                  : i == 1 ? 1 - 0x1p-24
                           : ((i * 2654435761U + j * 40503U) % 4093) / 4096.0);
  return x;
}

}  // namespace

TEST_CASE(
    "every integrand builds at all widths in both precisions; widths from 4 on agree bit for bit, "
    "and one lane too where the entry declares exact operations",
    "[device]") {
  std::map<std::uint32_t, std::vector<test::BatchItem>> by_dimension;
  for (const Integrand& f : test::catalog().integrands) {
    const std::uint32_t dim = std::clamp(2U, f.min_dim, f.max_dim);
    const Scene scene = parse_scene(test::catalog(), fmt::format("{}:d={}", f.name, dim), "test");
    by_dimension[dim].push_back({scene, some_points(dim)});
  }
  for (const auto& [dim, items] : by_dimension) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      const auto wide = test::evaluate(items, precision, 16);
      for (const std::uint32_t lanes : {1U, 4U, 8U}) {
        const auto other = test::evaluate(items, precision, lanes);
        for (std::size_t k = 0; k < items.size(); ++k) {
          const Integrand& f = test::catalog().integrand(items[k].scene.integrand, "test");
          INFO(f.name << " " << precision_name(precision) << " lanes " << lanes);
          CHECK(other[k].drawn == dim);
          if (lanes == 1 && !f.exact_operations) continue;
          CHECK(std::equal(wide[k].f.begin(), wide[k].f.end(), other[k].f.begin(), same_value));
        }
      }
    }
  }
}

namespace {

// All widths give the bits of 16 lanes; the integrand has exact operations.
void check_widths(const Sampler& sampler, const std::string& sum, Precision precision) {
  Cell cell =
      test::cell(fmt::format("linear-prod:d={}", test::usual_dim(sampler)), sampler.name, 256);
  cell.n = {test::admitted_size(sampler, cell.scene.dim, 256)};
  cell.precision = precision;
  cell.sum = sum;
  const auto wide = test::partial_sums(cell, {16, 1, {}, {}});
  for (const std::uint32_t lanes : {1U, 4U, 8U}) {
    INFO(sampler.name << " " << sum << " " << precision_name(precision) << " lanes " << lanes);
    const auto other = test::partial_sums(cell, {lanes, 1, {}, {}});
    REQUIRE(other.size() == wide.size());
    CHECK(std::equal(wide.begin(), wide.end(), other.begin(), same_value));
  }
}

}  // namespace

TEST_CASE("every sampler builds and sums to the same bits at all widths in fp32", "[device]") {
  // samplers_test meets them in fp64. Sums are dealt out over the samplers; of samplers with the
  // same kernel one is enough.
  const auto& sums = test::catalog().sums;
  std::size_t i = 0;
  for (const Sampler& sampler : test::samplers_by_kernel())
    if (test::precisions(sampler).front() == Precision::fp32)
      check_widths(sampler, sums[i++ % sums.size()].name, Precision::fp32);
  CHECK(i > 10);
}

TEST_CASE("every sum builds and gives the same bits at all widths in both precisions", "[device]") {
  const Sampler sampler = test::samplers_by_kernel().front();
  for (const SumAlgorithm& sum : test::catalog().sums)
    for (const Precision precision : {Precision::fp32, Precision::fp64})
      check_widths(sampler, sum.name, precision);
}
