// Every kernel piece builds and agrees at widths 1, 4, 8, 16 in fp32 and fp64.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "tests/support.hpp"

using namespace koksma;

namespace {

// Samplers and sums are dealt out over the integrands, so that each piece meets every width and
// precision. Of samplers with the same kernel one is enough.
struct Pairing {
  std::string integrand, sampler, sum;
};

std::vector<Pairing> pairings() {
  const Catalog& catalog = test::catalog();
  const std::vector<Sampler> samplers = test::samplers_by_kernel();
  const std::size_t count =
      std::max({catalog.integrands.size(), samplers.size(), catalog.sums.size()});
  std::vector<Pairing> result;
  for (std::size_t i = 0; i < count; ++i)
    result.push_back({catalog.integrands[i % catalog.integrands.size()].name,
                      samplers[i % samplers.size()].name,
                      catalog.sums[i % catalog.sums.size()].name});
  return result;
}

// The scene nearest to the integrand's default that the sampler has dimensions for.
std::string scene_of(const Integrand& f, const Sampler& s) {
  const std::uint32_t dim = std::clamp(f.default_dim, s.min_dim, s.max_dim);
  return fmt::format("{}:d={}", f.name, std::clamp(dim, f.min_dim, f.max_dim));
}

}  // namespace

TEST_CASE(
    "every integrand, sampler and sum builds at all widths in both precisions, and widths from 4 "
    "on agree bit for bit",
    "[device]") {
  std::set<std::string> covered;
  for (const Pairing& p : pairings()) {
    covered.insert({p.integrand, p.sampler, p.sum});
    const Integrand& f = test::catalog().integrand(p.integrand, "test");
    const auto agree = [](double a, double b) {
      return a == b || (std::isnan(a) && std::isnan(b));
    };
    const Sampler sampler = test::catalog().sampler(p.sampler, "test");
    for (const Precision precision : test::precisions(sampler)) {
      Cell cell = test::cell(scene_of(f, sampler), p.sampler, 256);
      cell.n = {test::admitted_size(sampler, cell.scene.dim, 256)};
      cell.precision = precision;
      cell.sum = p.sum;
      const auto wide = test::partial_sums(cell, {16, 1, {}, {}});
      for (const std::uint32_t lanes : {1U, 4U, 8U}) {
        INFO(p.integrand << " " << p.sampler << " " << p.sum << " " << precision_name(precision)
                         << " lanes " << lanes);
        const auto other = test::partial_sums(cell, {lanes, 1, {}, {}});
        REQUIRE(other.size() == wide.size());
        const bool same = std::equal(wide.begin(), wide.end(), other.begin(), agree);
        if (lanes != 1 || f.exact_operations) CHECK(same);
      }
    }
  }
  for (const auto& f : test::catalog().integrands) CHECK(covered.count(f.name) == 1);
  for (const auto& s : test::catalog().sums) CHECK(covered.count(s.name) == 1);
}
