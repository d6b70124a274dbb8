#include "device/exact.hpp"

#include <array>
#include <cmath>

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
  return true;
}

std::optional<double> from_table(const Integrand& f, const Scene& scene, const char* key) {
  const Json* check = matching_check(f, scene);
  if (check == nullptr || !check->contains(key) || !(*check)[key].is_string()) return std::nullopt;
  return std::stod((*check)[key].get<std::string>());
}

std::optional<double> resolve(const ExactSource& source, double computed,
                              const std::optional<double>& mean, const Integrand& f,
                              const Scene& scene, const char* key) {
  switch (source.kind) {
    case Kind::formula:
      return std::isfinite(computed) ? std::optional(computed) : std::nullopt;
    case Kind::mean:
      return mean;
    case Kind::table:
      return from_table(f, scene, key);
    case Kind::none:
      break;
  }
  return std::nullopt;
}

}  // namespace

const Json* matching_check(const Integrand& integrand, const Scene& scene) {
  for (const Json& check : integrand.checks)
    if (same_scene(check, integrand, scene)) return &check;
  return nullptr;
}

ExactValues compute_exact(Device& device, const Integrand& integrand, const Scene& scene) {
  ExactValues result;
  std::array<double, 4> out{};
  const bool computes =
      integrand.mean.kind == Kind::formula || integrand.variance.kind == Kind::formula ||
      integrand.mean_abs.kind == Kind::formula || integrand.variation.kind == Kind::formula;
  if (computes || !integrand.coefficients.empty()) {
    const BuiltProgram built = device.build(exact_program(integrand));
    checked([&] {
      const cl::Buffer values =
          device.upload(scene.parameters.data(), scene.parameters.size() * sizeof(double));
      cl::CommandQueue& queue = device.queue();
      if (computes) {
        const cl::Buffer buffer = device.allocate(sizeof(out));
        cl::Kernel kernel(built.program, "exact_values");
        kernel.setArg(0, values);
        kernel.setArg(1, cl_uint{scene.dim});
        kernel.setArg(2, buffer);
        queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
        queue.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof(out), out.data());
      }
      if (!integrand.coefficients.empty()) {
        result.coefficients.resize(std::size_t{scene.dim} * integrand.coefficients.size());
        const cl::Buffer buffer = device.allocate(result.coefficients.size() * sizeof(double));
        cl::Kernel kernel(built.program, "setup_coefficients");
        kernel.setArg(0, values);
        kernel.setArg(1, cl_uint{scene.dim});
        kernel.setArg(2, buffer);
        queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(scene.dim), cl::NDRange(1));
        queue.enqueueReadBuffer(buffer, CL_TRUE, 0, result.coefficients.size() * sizeof(double),
                                result.coefficients.data());
      }
    });
  }
  result.mean = resolve(integrand.mean, out[0], std::nullopt, integrand, scene, "mean");
  result.variance = resolve(integrand.variance, out[1], std::nullopt, integrand, scene, "variance");
  result.mean_abs = resolve(integrand.mean_abs, out[2], result.mean, integrand, scene, "mean_abs");
  result.variation =
      resolve(integrand.variation, out[3], std::nullopt, integrand, scene, "variation");
  return result;
}

}  // namespace koksma
