// Operations per coordinate, counted by running, are those that one counts by hand.
#include "device/operations.hpp"

#include <catch2/catch.hpp>
#include <map>

#include "plan/instrument.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

OperationCount counted(const std::string& scene, const std::string& sampler, Precision precision) {
  Cell cell = test::cell(scene, sampler, 1024);
  cell.precision = precision;
  const Plan plan = make_plan(test::catalog(), cell, test::device().facts());
  const ExactValues exact = compute_exact(test::device(), *plan.integrand, plan.cell.scene);
  return count_operations(test::device(), test::catalog(), plan, exact.coefficients);
}

using Slots = std::map<std::string, double>;

Slots of(const OperationCount& count, double OperationRow::*slot) {
  Slots slots;
  for (const OperationRow& row : count.vectors)
    if (row.*slot > 0) slots[row.name] = row.*slot;
  return slots;
}

}  // namespace

TEST_CASE("operations of a net and a product are those of the hand-written limit", "[device]") {
  const OperationCount count = counted("linear-prod:d=8", "sobol-shift", Precision::fp32);
  CHECK(count.lanes == 16);
  CHECK(count.samples == 1024);
  // One XOR steps a coordinate, and one conversion makes the signed word x - 1/2.
  CHECK(of(count, &OperationRow::points) == Slots{{"bitwise", 1}, {"convert", 1}});
  // c times its unit (which compilers take out of the loop), times x - 1/2, + 1, times the product.
  CHECK(of(count, &OperationRow::integrand) == Slots{{"add", 1}, {"multiply", 3}});
  // Once per sample of 8 coordinates: a conversion and an addition in fp64.
  CHECK(of(count, &OperationRow::sum) == Slots{{"convert", 0.125}, {"add", 0.125}});
  CHECK_FALSE(count.points_dominate());
}

TEST_CASE("operations of a lattice and a sum are those that its kernel takes", "[device]") {
  const OperationCount count = counted("exp-sum:d=8", "lattice-shift", Precision::fp32);
  // An addition steps it, a load brings the step of all lanes; half a unit and the conversion.
  CHECK(of(count, &OperationRow::points) ==
        Slots{{"add", 1}, {"load", 1}, {"bitwise", 1}, {"convert", 1}});
  const Slots integrand = of(count, &OperationRow::integrand);
  CHECK(integrand.at("fma") == 1);
  CHECK(integrand.at("exp") == 0.125);
  CHECK(count.points_dominate());
}

TEST_CASE("operations of random points are those of ten Philox rounds per quartet", "[device]") {
  const OperationCount count = counted("linear-prod:d=8", "random", Precision::fp32);
  const Slots points = of(count, &OperationRow::points);
  // Per round and quartet 2 wide products, of the even and of the odd lanes.
  CHECK(points.at("multiply") == 10 * 2 * 2 / 4.0);
  CHECK(points.at("bitwise") > 10);
  CHECK(count.points_dominate());
  CHECK(of(count, &OperationRow::integrand) == Slots{{"add", 1}, {"multiply", 3}});
  // Monte Carlo sums squares too: a subtraction, a product and an addition per sample.
  CHECK(of(count, &OperationRow::sum) ==
        Slots{{"convert", 0.125}, {"add", 0.375}, {"multiply", 0.125}});
}

TEST_CASE("loops, branches, macros and calls count as often as they are taken", "[unit]") {
  std::vector<std::string> operations{"scalar", "element"};
  const std::string text = instrumented(
      "#define KOKSMA_STEP(r, c) sum = fma(sum, r, c);\ntypedef float4 real;\n"
      "static inline real inner(void) { return (real)(1.0f) * 2; }\n"
      "static real f(real x, uint n) {\n  real sum = x;\n  for (uint i = 0; i < n; ++i) sum += x;\n"
      "  if (n > 1)\n    return sum * inner();\n  KOKSMA_STEP(x, sum)\n  return sum;\n}\n"
      "__kernel void k(void) { f(1, 2); }\n",
      operations);
  INFO(text);
  CHECK(operations ==
        std::vector<std::string>{"scalar", "element", "multiply", "compare", "add", "fma"});
  for (const char* part :
       {"inner(koksma_counted *koksma_counting", "f(koksma_counted *koksma_counting, real x",
        "KOKSMA_COUNT(2, ((real)(1.0f) * 2));", "KOKSMA_COUNT(5, (fma(sum, x, sum)));",
        "inner(koksma_counting)", "f(koksma_counting, 1, 2)", "KOKSMA_COUNT(4, (sum)); sum += x;"})
    CHECK_THAT(text, Catch::Contains(part));
}

TEST_CASE("every integrand and every sampler can be read to count operations", "[unit]") {
  std::size_t programs = 0;
  const auto read = [&](const std::string& scene, const Sampler& sampler) {
    INFO(scene << " " << sampler.name);
    const std::uint32_t dim = parse_scene(test::catalog(), scene, "test").dim;
    const Plan plan = make_plan(
        test::catalog(), test::cell(scene, sampler.name, test::admitted_size(sampler, dim, 256)),
        DeviceFacts{});
    CHECK_NOTHROW(counting_operations(test::catalog(), plan));
    ++programs;
  };
  const Sampler sobol = test::catalog().sampler("sobol", "test");
  for (const Integrand& f : test::catalog().integrands) read(f.name, sobol);
  for (const Sampler& sampler : test::samplers_by_kernel())
    read("linear-prod:d=" + std::to_string(test::usual_dim(sampler)), sampler);
  CHECK(programs > 80);
}
