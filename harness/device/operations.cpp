#include "device/operations.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "device/arguments.hpp"
#include "device/prepare.hpp"
#include "error/error.hpp"
#include "plan/instrument.hpp"

namespace koksma {
namespace {

constexpr std::uint64_t kMostSteps = 64;

double total(const OperationCount& count, double OperationRow::*slot) {
  double sum = 0;
  for (const OperationRow& row : count.vectors) sum += row.*slot;
  return sum;
}

std::vector<std::uint64_t> run(Device& device, const Plan& plan, const InstrumentedProgram& program,
                               const std::vector<double>& coefficients, std::uint32_t steps) {
  const BuiltProgram built = device.build(program.source);
  const std::uint64_t n = plan.cell.n.back();
  const std::vector<std::byte> table = point_table(device, plan, n);
  std::vector<std::uint64_t> counts(program.operations.size() * std::size(kCountedSlots));
  const std::size_t bytes = counts.size() * sizeof counts[0];
  checked([&] {
    cl::Kernel kernel(built.program, "count_operations");
    const cl::Buffer table_buffer = device.upload(table.data(), table.size());
    const cl::Buffer values = device.upload_reals(plan.cell.scene.parameters, plan.fp64());
    const cl::Buffer c = device.upload_reals(coefficients, plan.fp64());
    const cl::Buffer out = device.allocate(bytes);
    kernel.setArg(0, table_buffer);
    kernel.setArg(1, values);
    kernel.setArg(2, c);
    kernel.setArg(3, cl_ulong{n});
    kernel.setArg(4, cl_ulong{plan.cell.seed});
    kernel.setArg(5, cl_uint{steps});
    kernel.setArg(6, out);
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    return device.queue().enqueueReadBuffer(out, CL_TRUE, 0, bytes, counts.data());
  });
  return counts;
}

std::string table_row(const OperationRow& row) {
  return fmt::format("  {:<14}{:>10.2f}{:>12.2f}{:>10.2f}\n", row.name, row.points, row.integrand,
                     row.sum);
}

Json row_json(const OperationRow& row) {
  return {
      {"name", row.name}, {"points", row.points}, {"integrand", row.integrand}, {"sum", row.sum}};
}

}  // namespace

double OperationCount::points() const { return total(*this, &OperationRow::points); }
double OperationCount::integrand() const { return total(*this, &OperationRow::integrand); }

OperationCount count_operations(Device& device, const Catalog& catalog, const Plan& plan,
                                const std::vector<double>& coefficients) {
  Plan vectors = plan;
  vectors.shape.local_size = 1;
  // Lanes are told from scalars by their size, so there must be some.
  if (plan.shape.lanes_per_item == 1 && device.facts().is_cpu)
    throw UnsupportedError(
        fmt::format("operations are told by vectors of lanes, and at d = {} an item has one lane",
                    plan.request.dim));
  vectors.shape.lanes_per_item = std::max(plan.shape.lanes_per_item, 4U);
  const InstrumentedProgram program = counting_operations(catalog, vectors);
  const auto steps = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(plan.cell.n.back() / kLanes, 1, kMostSteps));
  const std::vector<std::uint64_t> counts = run(device, vectors, program, coefficients, steps);

  OperationCount result;
  result.lanes = vectors.shape.lanes_per_item;
  result.samples = std::uint64_t{steps} * result.lanes;
  result.coordinates = plan.request.dim;
  const std::size_t names = program.operations.size();
  const double each = 1 / (static_cast<double>(steps) * plan.request.dim);
  for (std::size_t i = 0; i < names; ++i) {
    const auto at = [&](std::size_t slot) {
      return static_cast<double>(counts[slot * names + i]) * each;
    };
    OperationRow row{program.operations[i], at(0), at(1), at(2)};
    if (i == 0)
      result.scalar = row;
    else if (i == 1)
      result.element = row;
    else if (row.points + row.integrand + row.sum > 0)
      result.vectors.push_back(row);
  }
  const auto frequency = [](const OperationRow& row) {
    return row.points + row.integrand + row.sum;
  };
  std::stable_sort(result.vectors.begin(), result.vectors.end(),
                   [&](const auto& a, const auto& b) { return frequency(a) > frequency(b); });
  return result;
}

std::string operations_table(const OperationCount& count) {
  std::string text = fmt::format("  {:<14}{:>10}{:>12}{:>10}\n", "", "points", "integrand", "sum");
  for (const OperationRow& row : count.vectors) text += table_row(row);
  text += table_row({"all", count.points(), count.integrand(), total(count, &OperationRow::sum)});
  text += table_row(count.scalar);
  text += table_row(count.element);
  return text;
}

Json operations_json(const OperationCount& count) {
  Json vectors = Json::array();
  for (const OperationRow& row : count.vectors) vectors.push_back(row_json(row));
  return {{"samples", count.samples},         {"lanes", count.lanes},
          {"coordinates", count.coordinates}, {"vectors", vectors},
          {"scalar", row_json(count.scalar)}, {"element", row_json(count.element)},
          {"points", count.points()},         {"integrand", count.integrand()}};
}

}  // namespace koksma
