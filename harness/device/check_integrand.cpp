#include "device/check_integrand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "catalog/lanes.hpp"

namespace koksma {
namespace {

constexpr double kTolerance = 1e-9;  // relative, of a user's own reference values at least

// Points without a table: an integrand that draws too much then reads no array beyond its end.
const Sampler& tableless_sampler(const Catalog& catalog) {
  return *std::find_if(catalog.samplers.begin(), catalog.samplers.end(),
                       [](const Sampler& s) { return find_table_builder(s.family) == nullptr; });
}

// The fewest and the most coordinates that a sample draws, of kDrawSteps samples of every lane.
constexpr cl_uint kDrawSteps = 256;
struct Drawn {
  cl_uint fewest, most;
};

Drawn drawn_coordinates(const Catalog& catalog, Device& device, const Cell& cell,
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
    const std::size_t groups = kLanes / plan.shape.lanes_per_item, local = plan.shape.local_size;
    const cl::Buffer out = device.allocate(groups * sizeof(Drawn));
    cl::Kernel kernel(built.program, "dump_draws");
    kernel.setArg(0, table);
    kernel.setArg(1, values);
    kernel.setArg(2, coefficients);
    kernel.setArg(3, cl_ulong{kLanes} * kDrawSteps);
    kernel.setArg(4, cl_ulong{1});
    kernel.setArg(5, kDrawSteps);
    kernel.setArg(6, out);
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange,
                                        cl::NDRange((groups + local - 1) / local * local),
                                        cl::NDRange(local));
    std::vector<Drawn> drawn(groups);
    device.queue().enqueueReadBuffer(out, CL_TRUE, 0, groups * sizeof(Drawn), drawn.data());
    Drawn all = drawn.front();
    for (const Drawn& group : drawn)
      all = {std::min(all.fewest, group.fewest), std::max(all.most, group.most)};
    return all;
  });
}

// What the compiler says of the user's file is the user's; of others, the implementation's.
template <typename Call>
auto told_as_input(const Integrand& f, Call&& call) {
  try {
    return call();
  } catch (const BuildError& error) {
    const std::string text = error.what();
    if (text.find(f.code.path) == std::string::npos) throw;
    throw InputError(f.code.path, "does not compile:" + text.substr(text.find('\n')), "");
  }
}

std::string pointer(const Integrand& f, const char* key) {
  const auto entry = std::filesystem::path(f.code.path).replace_extension(".json");
  return fmt::format("{}, at '/exact/{}'", entry.string(), key);
}

// Where the check gives digits, there must be a number, and that one.
void compare(const Integrand& f, const ExactSource& source, const char* key,
             const std::optional<double>& value, const Json& check) {
  using Kind = ExactSource::Kind;
  const bool formula = source.kind == Kind::formula;
  if ((!formula && source.kind != Kind::constant) || !check[key].is_string()) return;
  const std::string digits = check[key];
  if (digits == "inf") return;
  const double expected = std::stod(digits);
  const double scale = expected == 0 ? 1 : std::fabs(expected);
  if (value && std::fabs(*value - expected) <= std::max(kTolerance, source.tolerance) * scale)
    return;
  throw InputError(
      formula ? f.code.path : pointer(f, key),
      fmt::format("{} gives {} at d = {}", formula ? fmt::format("exact_{}", key) : "the constant",
                  value ? fmt::format("{}", *value) : "no finite number",
                  check["d"].get<std::uint32_t>()),
      fmt::format("the entry's check says {}", digits));
}

}  // namespace

void check_user_integrand(const Catalog& catalog, Device& device, Device& exact_device,
                          const Cell& cell) {
  const Integrand& f = catalog.integrand(cell.scene.integrand, "scene");
  const ExactValues exact =
      told_as_input(f, [&] { return compute_exact(exact_device, f, cell.scene); });
  if (f.mean.kind == ExactSource::Kind::formula && !exact.mean)
    throw InputError(
        pointer(f, "mean"),
        fmt::format("the formula gives no finite number for {}", cell.scene.text),
        "limit the parameters, or say \"none\" where it is unknown, \"undefined\" where f has no "
        "mean");
  const Drawn drawn =
      told_as_input(f, [&] { return drawn_coordinates(catalog, device, cell, exact); });
  if (drawn.fewest != drawn.most)
    throw InputError(f.code.path,
                     fmt::format("the kernel draws {} to {} coordinates, by the sample",
                                 drawn.fewest, drawn.most),
                     fmt::format("every sample has to draw all d = {}", cell.scene.dim));
  if (drawn.most != cell.scene.dim)
    throw InputError(f.code.path,
                     fmt::format("the kernel draws {} coordinates per sample", drawn.most),
                     fmt::format("the scene has d = {}", cell.scene.dim));
  for (const Json& check : f.checks) {
    const Scene scene = scene_of(f, check["d"], check["parameters"]);
    const ExactValues computed = compute_exact(exact_device, f, scene);
    compare(f, f.mean, "mean", computed.mean, check);
    compare(f, f.variance, "variance", computed.variance, check);
  }
}

}  // namespace koksma
