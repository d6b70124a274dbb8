#include "device/exact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "error/error.hpp"

namespace koksma {
namespace {

using Kind = ExactSource::Kind;

bool same_scene(const Json& check, const Integrand& f, const Scene& scene) {
  if (check["d"] != scene.dim) return false;
  for (std::size_t i = 0; i < f.parameters.size(); ++i) {
    const double value =
        check["parameters"].value(f.parameters[i].name, f.parameters[i].default_value);
    if (value != scene.parameters[i]) return false;
  }
  // What a check does not say holds for all values.
  for (std::size_t i = 0; i < f.choices.size(); ++i)
    if (check["parameters"].value(f.choices[i].name, scene.choices[i]) != scene.choices[i])
      return false;
  return true;
}

std::optional<double> from_table(const Integrand& f, const Scene& scene, const char* key) {
  const Json* check = matching_check(f, scene);
  if (check == nullptr || !check->contains(key) || !(*check)[key].is_string()) return std::nullopt;
  const double value = std::stod((*check)[key].get<std::string>());
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool variance_check_says_infinite(const Integrand& f, const Scene& scene) {
  const Json* check = f.variance.kind == Kind::table ? matching_check(f, scene) : nullptr;
  return check != nullptr && (*check)["variance"] == "inf";
}

std::optional<double> resolve(const ExactSource& source, double computed,
                              const std::optional<double>& mean, const Integrand& f,
                              const Scene& scene, const char* key) {
  switch (source.kind) {
    case Kind::formula:
      return std::isfinite(computed) ? std::optional(computed) : std::nullopt;
    case Kind::mean:
      return mean;
    case Kind::constant:
      return source.value;
    case Kind::table:
      return from_table(f, scene, key);
    case Kind::none:
    case Kind::undefined:
      break;
  }
  return std::nullopt;
}

// The integrand's exact program with its arguments, run on one device.
class ExactProgram {
 public:
  ExactProgram(Device& device, const Integrand& integrand, const Scene& scene)
      : device_(device),
        dim_(scene.dim),
        program_(device.build(exact_program(integrand, scene)).program),
        values_(device.upload(scene.parameters.data(), scene.parameters.size() * sizeof(double))) {}

  // What `items` work-items of one kernel wrote.
  template <typename T>
  std::vector<T> run(const char* name, std::size_t items, std::size_t count) {
    return checked([&] {
      std::vector<T> out(count);
      const cl::Buffer buffer = device_.allocate(count * sizeof(T));
      cl::Kernel kernel(program_, name);
      kernel.setArg(0, values_);
      kernel.setArg(1, cl_uint{dim_});
      kernel.setArg(2, buffer);
      device_.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items),
                                           cl::NDRange(1));
      device_.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), out.data());
      return out;
    });
  }

 private:
  Device& device_;
  std::uint32_t dim_;
  cl::Program program_;
  cl::Buffer values_;
};

bool has_formula(const Integrand& f) {
  return f.mean.kind == Kind::formula || f.variance.kind == Kind::formula ||
         f.mean_abs.kind == Kind::formula || f.variation.kind == Kind::formula ||
         f.discrete.kind == Kind::formula || f.bound.kind == Kind::formula ||
         f.stiffness.kind == Kind::formula;
}

// A permutation that keeps draw 0 in place: sets of which coordinate 0 is special (Hammersley) then
// need no other kernel.
void check_order(const Integrand& f, const Scene& scene, std::vector<std::uint32_t> order) {
  const std::string allowed =
      fmt::format("a permutation of 0 to {} that begins with 0", scene.dim - 1);
  const bool begins_with_0 = order.front() == 0;
  std::sort(order.begin(), order.end());
  for (std::uint32_t k = 0; k < scene.dim; ++k)
    if (order[k] != k || !begins_with_0)
      throw InputError(f.code.path, fmt::format("dimension_order at d = {}", scene.dim), allowed);
}

}  // namespace

const Json* matching_check(const Integrand& integrand, const Scene& scene) {
  for (const Json& check : integrand.checks)
    if (same_scene(check, integrand, scene)) return &check;
  return nullptr;
}

double blow_up_limit(const ExactValues& exact) {
  const double huge = exact.mean_abs && *exact.mean_abs > 0 ? 1e30 * *exact.mean_abs : INFINITY;
  return exact.bound ? std::min(10 * *exact.bound, huge) : huge;
}

ExactValues compute_exact(Device& device, const Integrand& integrand, const Scene& scene) {
  ExactValues result;
  std::vector<double> out(9, std::nan(""));
  if (has_formula(integrand) || !integrand.coefficients.empty() || integrand.dimension_order) {
    ExactProgram program(device, integrand, scene);
    if (has_formula(integrand)) out = program.run<double>("exact_values", 1, 9);
    if (!integrand.coefficients.empty())
      result.coefficients = program.run<double>("setup_coefficients", scene.dim,
                                                scene.dim * integrand.coefficients.size());
    if (integrand.dimension_order) {
      result.dimension_order = program.run<std::uint32_t>("order_dimensions", scene.dim, scene.dim);
      check_order(integrand, scene, result.dimension_order);
    }
  }
  result.mean_undefined =
      integrand.mean.kind == Kind::undefined || (integrand.mean.infinite && std::isinf(out[0]));
  result.infinite_variance = (integrand.variance.infinite && out[1] == INFINITY) ||
                             variance_check_says_infinite(integrand, scene);
  result.variance_overflows =
      integrand.variance.kind == Kind::formula && out[1] == INFINITY && !result.infinite_variance;
  result.mean = resolve(integrand.mean, out[0], std::nullopt, integrand, scene, "mean");
  result.variance = resolve(integrand.variance, out[1], std::nullopt, integrand, scene, "variance");
  result.mean_abs = resolve(integrand.mean_abs, out[2], result.mean, integrand, scene, "mean_abs");
  result.variation =
      resolve(integrand.variation, out[3], std::nullopt, integrand, scene, "variation");
  const auto finite = [](double value) {
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  };
  result.discrete_mean = finite(out[4]);
  result.discrete_variance = finite(out[5]);
  result.discrete_mean_abs = finite(out[6]);
  result.discrete_overflows = std::isinf(out[4]) || std::isinf(out[5]) || std::isinf(out[6]);
  result.bound = resolve(integrand.bound, out[7], std::nullopt, integrand, scene, "bound");
  result.stiffness =
      resolve(integrand.stiffness, out[8], std::nullopt, integrand, scene, "stiffness");
  return result;
}

}  // namespace koksma
