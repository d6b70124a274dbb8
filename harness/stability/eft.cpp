#include "stability/eft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "error/error.hpp"
#include "estimate/summation.hpp"
#include "stability/self_test.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kTenthsAdded = std::uint32_t{1} << 20;

std::vector<const SumAlgorithm*> compensated_sums(const Catalog& catalog, bool has_fp64) {
  std::vector<const SumAlgorithm*> sums;
  for (const SumAlgorithm& sum : catalog.sums)
    if (sum.compensated && (has_fp64 || !sum.needs_fp64)) sums.push_back(&sum);
  return sums;
}

void test_transformations(SelfTestProgram& program, bool fp64, EftResult& result) {
  const auto expect = [&](std::string what, double expected, double got) {
    result.tests.push_back({std::move(what), expected, got, got == expected});
  };
  // The smaller term is lost altogether, whichever comes first.
  const double large = fp64 ? 1e16 : 1e8;
  expect(fmt::format("the error of TwoSum({:g}, 0.375)", large), 0.375,
         program.call("two_sum", {large, 0.375}, 2)[1]);
  expect(fmt::format("the error of TwoSum(0.375, {:g})", large), 0.375,
         program.call("two_sum", {0.375, large}, 2)[1]);
  // (1 + h)^2 = 1 + 2 h + h^2, of which h^2 is below half a unit of the last place, or just that.
  const double h = fp64 ? 0x1p-27 : 0x1p-12;
  const double splitter = fp64 ? 0x1p27 + 1 : 0x1p12 + 1;
  const char* const name = fp64 ? "1 + 2^-27" : "1 + 2^-12";
  expect(fmt::format("the error of TwoProd({0}, {0})", name), h * h,
         program.call("two_prod", {1 + h, 1 + h, splitter}, 2)[1]);
  expect(fmt::format("({0}) ({0}) less its rounded value, uncontracted", name), 0,
         program.call("uncontracted", {1 + h, 1 + h, 1 + 2 * h}, 1)[0]);
}

// What is left of a sum whose correction was optimised away.
double naive_sum(double term, bool fp64) {
  double wide = 0;
  float narrow = 0;
  for (std::uint32_t i = 0; i < kTenthsAdded; ++i) {
    wide += term;
    narrow += static_cast<float>(term);
  }
  return fp64 ? wide : static_cast<double>(narrow);
}

void test_sum(SelfTestProgram& program, std::size_t k, const SumAlgorithm& sum, EftResult& result) {
  const bool fp64 = result.precision == Precision::fp64;
  const double tenth = fp64 ? 0.1 : static_cast<double>(0.1F);
  ExactSum exact;
  exact.add_product(tenth, kTenthsAdded);
  EftTest test{fmt::format("2^20 x 0.1 with sum '{}'", sum.name), exact.rounded(), 0, false};
  test.got = program.add_up(k, {tenth}, kTenthsAdded).rounded();
  const double bound = summation_bound(sum, result.precision, kTenthsAdded).of(test.expected);
  test.passed = std::fabs(test.got - test.expected) <= bound && test.got != naive_sum(tenth, fp64);
  result.tests.push_back(std::move(test));
  for (const SumKnownAnswer& answer : sum.self_test) {
    std::string terms;
    for (const double term : answer.terms)
      terms += fmt::format("{}{:g}", terms.empty() ? "" : ", ", term);
    const auto count = static_cast<std::uint32_t>(answer.terms.size());
    const double got = program.add_up(k, answer.terms, count).rounded();
    result.tests.push_back(
        {fmt::format("[{}] with sum '{}'", terms, sum.name), answer.sum, got, got == answer.sum});
  }
}

}  // namespace

const std::vector<std::string>& eft_option_sets() {
  static const std::vector<std::string> sets{"",
                                             "-cl-mad-enable",
                                             "-cl-denorms-are-zero",
                                             "-cl-finite-math-only",
                                             "-cl-unsafe-math-optimizations",
                                             kRelaxedMathOption};
  return sets;
}

bool EftResult::intact() const {
  return std::all_of(tests.begin(), tests.end(), [](const EftTest& test) { return test.passed; });
}

std::string EftResult::why_broken() const {
  for (const EftTest& test : tests)
    if (!test.passed)
      return fmt::format("EFT_BROKEN: {} is {:.17g}, not {:.17g}, in {}{}{}", test.what, test.got,
                         test.expected, precision_name(precision), options.empty() ? "" : " under ",
                         options);
  return "";
}

EftResult test_error_free_transformations(const Catalog& catalog, Device& device,
                                          Precision precision, const std::string& options) {
  const bool fp64 = precision == Precision::fp64;
  const auto sums = compensated_sums(catalog, device.facts().fp64);
  SelfTestProgram program(device, "eft", sums, precision, options);
  EftResult result;
  result.options = options;
  result.precision = precision;
  test_transformations(program, fp64, result);
  for (std::size_t k = 0; k < sums.size(); ++k) test_sum(program, k, *sums[k], result);
  return result;
}

std::string EftSelfTest::why_broken(const Plan& plan) {
  if (!plan.sum->compensated) return "";
  const auto [place, fresh] = known_.try_emplace({plan.precision, plan.relaxed_math});
  if (fresh)
    place->second = test_error_free_transformations(catalog_, device_, plan.precision,
                                                    plan.relaxed_math ? kRelaxedMathOption : "")
                        .why_broken();
  return place->second;
}

void EftSelfTest::require(const Plan& plan) {
  const std::string why = why_broken(plan);
  if (!why.empty())
    throw UnsupportedError(
        fmt::format("{}; sum '{}' needs error-free transformations", why, plan.sum->name));
}

}  // namespace koksma
