#include "device/check_integrand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace koksma {
namespace {

constexpr double kTolerance = 1e-9;  // of a user's own reference values

// Points without a table: an integrand that draws too much then reads no array beyond its end.
const Sampler& tableless_sampler(const Catalog& catalog) {
  return *std::find_if(catalog.samplers.begin(), catalog.samplers.end(),
                       [](const Sampler& s) { return find_table_builder(s.family) == nullptr; });
}

std::uint32_t drawn_coordinates(const Catalog& catalog, Device& device, const Cell& cell,
                                const ExactValues& exact) {
  Cell probe = cell;
  const Sampler& sampler = tableless_sampler(catalog);
  probe.sampler = sampler.name;
  probe.estimator = sampler.default_estimator;
  probe.sum = "";
  const Plan plan = make_plan(catalog, probe, device.facts());
  const BuiltProgram built = device.build(inspect_program(catalog, plan, true));
  return checked([&] {
    const std::uint64_t unused = 0;
    const cl::Buffer table = device.upload(&unused, sizeof(unused));
    const cl::Buffer values = device.upload_reals(cell.scene.parameters, plan.fp64());
    const cl::Buffer coefficients = device.upload_reals(exact.coefficients, plan.fp64());
    const cl::Buffer out = device.allocate(16 * sizeof(cl_uint));
    cl::Kernel kernel(built.program, "dump_draws");
    kernel.setArg(0, table);
    kernel.setArg(1, values);
    kernel.setArg(2, coefficients);
    kernel.setArg(3, cl_ulong{16});
    kernel.setArg(4, cl_ulong{1});
    kernel.setArg(5, out);
    const std::size_t local = plan.shape.local_size;
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(local),
                                        cl::NDRange(local));
    cl_uint drawn = 0;
    device.queue().enqueueReadBuffer(out, CL_TRUE, 0, sizeof(drawn), &drawn);
    return drawn;
  });
}

}  // namespace

void check_user_integrand(const Catalog& catalog, Device& device, Device& exact_device,
                          const Cell& cell) {
  const Integrand& f = catalog.integrand(cell.scene.integrand, "scene");
  const ExactValues exact = compute_exact(exact_device, f, cell.scene);
  const std::uint32_t drawn = drawn_coordinates(catalog, device, cell, exact);
  if (drawn != cell.scene.dim)
    throw InputError(f.code.path, fmt::format("the kernel draws {} coordinates per sample", drawn),
                     fmt::format("the scene has d = {}", cell.scene.dim));
  for (const Json& check : f.checks) {
    Scene scene = cell.scene;
    scene.dim = check["d"];
    for (std::size_t i = 0; i < f.parameters.size(); ++i)
      scene.parameters[i] =
          check["parameters"].value(f.parameters[i].name, f.parameters[i].default_value);
    const double expected = std::stod(check["mean"].get<std::string>());
    const auto mean = compute_exact(exact_device, f, scene).mean;
    if (mean && std::fabs(*mean - expected) > kTolerance * std::max(1.0, std::fabs(expected)))
      throw InputError(f.code.path, fmt::format("exact_mean gives {} at d = {}", *mean, scene.dim),
                       fmt::format("the entry's check says {}", check["mean"].get<std::string>()));
  }
}

}  // namespace koksma
