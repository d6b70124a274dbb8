// Error-free transformations: intact under strict options; where options break them, the self-test
// says so, and a compensated sum is refused.
#include "stability/eft.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "error/error.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

TEST_CASE("error-free transformations are intact under strict options, in both precisions",
          "[device]") {
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    const EftResult result =
        test_error_free_transformations(test::catalog(), test::device(), precision, "");
    std::size_t compensated = 0;
    for (const SumAlgorithm& sum : test::catalog().sums) compensated += sum.compensated ? 1 : 0;
    REQUIRE(result.tests.size() >= 4 + compensated);
    for (const EftTest& test : result.tests) {
      INFO(test.what << ": " << test.got << ", not " << test.expected);
      CHECK(test.passed);
    }
    CHECK(result.intact());
    CHECK(result.why_broken().empty());
  }
}

TEST_CASE("relaxed math breaks them on PoCL, and the self-test catches that", "[device]") {
  const EftResult result = test_error_free_transformations(test::catalog(), test::device(),
                                                           Precision::fp32, kRelaxedMathOption);
  CHECK_FALSE(result.intact());
  CHECK_THAT(result.why_broken(), StartsWith("EFT_BROKEN: the error of TwoSum(1e+08, 0.375) is 0, "
                                             "not 0.375, in fp32 under -cl-fast-relaxed-math"));
  // Every compensated sum is then the naive one, bit for bit.
  float naive = 0;
  for (int i = 0; i < 1 << 20; ++i) naive += 0.1F;
  std::size_t met = 0;
  for (const EftTest& test : result.tests) {
    if (test.what.find("2^20 x 0.1") == std::string::npos) continue;
    INFO(test.what);
    CHECK(test.got == static_cast<double>(naive));
    CHECK_FALSE(test.passed);
    ++met;
  }
  CHECK(met >= 3);
}

TEST_CASE("a compensated sum is refused where the self-test fails, and no other is asked about",
          "[device]") {
  EftSelfTest self_test(test::catalog(), test::device());
  for (const SumAlgorithm& sum : test::catalog().sums) {
    Cell cell = test::cell("linear-prod:d=1", "random", 256);
    cell.precision = Precision::fp32;
    cell.sum = sum.name;
    PlanOptions options;
    INFO(sum.name);
    CHECK_NOTHROW(
        self_test.require(make_plan(test::catalog(), cell, test::device().facts(), "", options)));
    options.relaxed_math = true;
    const Plan plan = make_plan(test::catalog(), cell, test::device().facts(), "", options);
    CHECK(self_test.why_broken(plan).empty() == !sum.compensated);
    if (!sum.compensated) continue;
    CHECK_THROWS_AS(self_test.require(plan), UnsupportedError);
    CHECK_THROWS_WITH(self_test.require(plan), StartsWith("EFT_BROKEN: ") && Contains(sum.name));
  }
}
