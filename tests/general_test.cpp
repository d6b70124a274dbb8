// General kernels integrate what planned ones do, and explain says what both take.
#include "plan/general.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "device/compare_general.hpp"
#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

Plan plan_of(const Sampler& sampler, Precision precision) {
  const std::uint32_t dim = std::clamp(6U, sampler.min_dim, sampler.max_dim);
  Cell cell = test::cell("linear-prod:d=" + std::to_string(dim), sampler.name,
                         test::admitted_size(sampler, dim, 500), sampler.replicable ? 3 : 1);
  cell.precision = precision;
  return make_plan(test::catalog(), cell, test::device().facts());
}

std::vector<double> coefficients(const Plan& plan) {
  return compute_exact(test::device(), *plan.integrand, plan.cell.scene).coefficients;
}

constexpr Rounds kOnce = {1, 1, 60};

}  // namespace

TEST_CASE("general kernels give the estimates of planned ones for every sampler that has one",
          "[device]") {
  std::set<std::string> families;
  std::size_t samplers = 0;
  for (const Sampler& sampler : test::catalog().samplers) {
    if (!test::complete(sampler)) continue;
    const Precision precision =
        test::precisions(sampler)[samplers % test::precisions(sampler).size()];
    const Plan plan = plan_of(sampler, precision);
    if (no_general_kernel(plan)) continue;
    INFO(sampler.name << " " << precision_name(precision));
    ++samplers;
    families.insert(sampler.family);
    const GeneralComparison result = compare_with_general(
        test::device(), test::catalog(), plan, coefficients(plan), plan.cell.n.back(), kOnce);
    CHECK(std::abs(result.planned - result.general) <= result.allowed);
    CHECK(result.allowed < 1e-4 * std::abs(result.planned));
    CHECK(result.planned_s > 0);
    CHECK(result.general_s > 0);
    CHECK(result.general_table >= result.planned_table);
  }
  CHECK(families.size() >= 4);
  CHECK(samplers >= 12);
}

TEST_CASE("a sampler without a general kernel is told with its reason", "[device]") {
  const Plan plan = plan_of(test::catalog().sampler("halton", "test"), Precision::fp64);
  REQUIRE(no_general_kernel(plan));
  CHECK_THAT(*no_general_kernel(plan),
             Contains("family 'halton' has no general kernel") && Contains("digital"));
  CHECK_THROWS_AS(general_plan(test::catalog(), plan), UnsupportedError);
  const test::CommandResult told =
      test::run_command("explain --scene linear-prod:d=2 --sampler halton --n 2^8 --measure");
  CHECK(told.status == 0);
  CHECK_THAT(told.output, Contains("measured    nothing: family 'halton' has no general kernel"));
}

TEST_CASE("explain --measure --json holds both times, their ratio, bytes and operations",
          "[device]") {
  const test::CommandResult result = test::run_command(
      "explain --scene linear-prod:d=6 --sampler sobol-shift --n 2^10 --replicates 3 --measure "
      "--json");
  INFO(result.output);
  REQUIRE(result.status == 0);
  const Json json = Json::parse(result.output);
  const Json& measured = json.at("measured");
  CHECK(measured.at("planned").at("kernel_s") > 0);
  CHECK(measured.at("ratio").get<double>() ==
        Approx(measured["general"]["kernel_s"].get<double>() /
               measured["planned"]["kernel_s"].get<double>()));
  CHECK(measured.at("n") == 1024);
  CHECK(json.at("table_bytes") < json.at("full_table_bytes"));
  CHECK(json.at("operations").at("points").get<double>() > 0);
  CHECK(json.at("left_out").size() > 4);
  CHECK_FALSE(Contains("__kernel").match(result.output));
}
