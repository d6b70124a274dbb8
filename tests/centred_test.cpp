// The slot of centred coordinates hands out x - 1/2 of the points that points_next draws.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>

#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "device/prepare.hpp"
#include "plan/compose.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr std::uint32_t kSteps = 20;  // of 16 points: more than one bit of the Gray code moves

// [slot][step][dimension][lane]: x - 1/2 from points_next, and what the centred slot says it is.
constexpr const char* kBothSlots = R"(
__kernel void both_slots(__global const word *table, ulong n, ulong seed, uint steps, __global scalar *out) {
  const uint lane = get_global_id(0) * KOKSMA_LANES_PER_ITEM;
  points p, q;
  points_seek(&p, table, 0, n, seed, 0, lane);
  points_seek(&q, table, 0, n, seed, 0, lane);
  const uint half_of = steps * KOKSMA_DIM * KOKSMA_LANES;
  for (uint j = 0; j < steps; ++j) {
    for (uint d = 0; d < KOKSMA_DIM; ++d) {
      __global scalar *place = out + (j * KOKSMA_DIM + d) * KOKSMA_LANES + lane;
      store_lanes(points_next(&p) - R(0.5), place);
      store_lanes((real)(points_next_centred(&q) * KOKSMA_CENTRED_UNIT), place + half_of);
    }
    points_step(&p);
    points_step(&q);
  }
}
)";

std::vector<double> both_slots(const Sampler& sampler, Precision precision, std::uint32_t lanes) {
  Device& device = test::device();
  const std::uint32_t dim = test::usual_dim(sampler);
  const std::uint64_t n = test::admitted_size(sampler, dim, std::uint64_t{16} * (kSteps + 1));
  Plan plan = make_points_plan(test::catalog(), sampler.name, dim, precision, n, 1, 1,
                               device.facts(), "", LaunchShape{lanes, 1, {}, {}});
  plan.request.centred_draws = !plan.sampler->rotated;
  ProgramSource source = compose_whole(test::catalog(), plan, ProgramKind::inspect);
  source.text += kBothSlots;
  cl::Kernel kernel(device.build(source).program, "both_slots");
  const std::vector<std::byte> table = point_table(device, plan);
  const cl::Buffer in = device.upload(table.data(), table.size());
  const std::size_t count = std::size_t{2} * kSteps * dim * 16, size = plan.fp64() ? 8 : 4;
  const cl::Buffer out = device.allocate(count * size);
  kernel.setArg(0, in);
  kernel.setArg(1, static_cast<cl_ulong>(n));
  kernel.setArg(2, static_cast<cl_ulong>(1));
  kernel.setArg(3, static_cast<cl_uint>(kSteps));
  kernel.setArg(4, out);
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(16 / lanes),
                                      cl::NDRange(1));
  std::vector<double> wide(count);
  std::vector<float> narrow(count);
  device.queue().enqueueReadBuffer(out, CL_TRUE, 0, count * size,
                                   plan.fp64() ? static_cast<void*>(wide.data()) : narrow.data());
  return plan.fp64() ? wide : std::vector<double>(narrow.begin(), narrow.end());
}

void check_slots(const Sampler& sampler, Precision precision, std::uint32_t lanes) {
  INFO(sampler.name << " " << precision_name(precision) << " lanes " << lanes);
  const auto values = both_slots(sampler, precision, lanes);
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  CHECK(std::equal(values.begin(), half, half));
  CHECK(std::any_of(half, values.end(), [](double x) { return x < 0; }));
  CHECK(std::any_of(half, values.end(), [](double x) { return x > 0; }));
}

// The partial sums of a cell in fp32, its integrand's centred slot spelt out as a difference or
// not, with counters or not.
std::vector<double> sums(const Cell& cell, bool spelt_out, bool counters) {
  Device& device = test::device();
  PlanOptions options;
  options.counters = counters;
  Plan plan = make_plan(test::catalog(), cell, device.facts(), "", options);
  Integrand f = *plan.integrand;
  REQUIRE(plan.request.centred_draws);
  if (spelt_out) {
    const std::regex slot(R"(points_next_centred\(p\))"), unit("KOKSMA_CENTRED_UNIT");
    f.code.text = std::regex_replace(
        std::regex_replace(f.code.text, slot, "(points_next(p) - R(0.5))"), unit, "R(1.0)");
    plan.integrand = &f;
    plan.request.centred_draws = false;
    plan.program = compose(test::catalog(), plan, ProgramKind::integrate);
  }
  const ExactValues exact = compute_exact(device, *plan.integrand, plan.cell.scene);
  Integrator integrator(device, plan, exact.coefficients);
  std::vector<double> result;
  integrator.run(cell.n.back(), 0,
                 [&](std::uint32_t, std::uint32_t, std::span<const double> partials) {
                   result.insert(result.end(), partials.begin(), partials.end());
                 });
  return result;
}

}  // namespace

TEST_CASE(
    "the centred slot is points_next - 1/2 exactly: every kernel of points in one width and "
    "precision, a family's own slot in all widths of fp32",
    "[device]") {
  const std::uint32_t widths[] = {1, 4, 8, 16};
  std::size_t deal = 0;
  for (const Sampler& sampler : test::samplers_by_kernel()) {
    const auto precisions = test::precisions(sampler);
    const Family& family = test::catalog().family(sampler.family);
    const bool own = family.code.text.find("points_next_centred") != std::string::npos;
    const bool narrow = std::count(precisions.begin(), precisions.end(), Precision::fp32) > 0;
    ++deal;
    if (own && narrow && deal % 4 == 1)
      for (const std::uint32_t lanes : widths) check_slots(sampler, Precision::fp32, lanes);
    else
      check_slots(sampler, own && narrow ? Precision::fp32 : precisions[deal % precisions.size()],
                  widths[deal % 4]);
  }
}

TEST_CASE(
    "an integrand that draws centred coordinates has the same sums, bit for bit, as one that "
    "subtracts 1/2, counted or not, in registers and beyond",
    "[device]") {
  for (const std::uint32_t dim : {8U, 17U}) {
    Cell cell = test::cell(fmt::format("linear-prod:d={}", dim), "sobol-shift", 1 << 12, 2);
    cell.precision = Precision::fp32;
    const auto expected = sums(cell, true, false);
    CHECK(sums(cell, false, false) == expected);
    if (dim == 8) CHECK(sums(cell, false, true) == expected);
  }
}
