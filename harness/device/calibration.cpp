#include "device/calibration.hpp"

#include <fmt/format.h>

#include <chrono>
#include <sstream>

#include "device/cache.hpp"
#include "plan/prune.hpp"
#include "plan/tokens.hpp"
#include "plan/untuned_shape.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

// Work-groups per compute unit: several, so that a core that is late is waited for less long.
constexpr std::size_t kGroupsPerUnit = 4;

}  // namespace

Calibration::Calibration(Device& device) : device_(device) {
  const LaunchShape shape = untuned_shape(device.facts());
  local_size_ = shape.local_size;
  items_ = std::size_t{device.facts().compute_units} * kGroupsPerUnit * local_size_;
  const BuiltProgram built = device.build(calibration_program(shape));
  kernel_ = checked([&] { return cl::Kernel(built.program, "calibrate"); });
  out_ = device.allocate(items_ * sizeof(float));
  run();
  launches_ = 0;
  wall_s_ = 0;
}

std::string Calibration::identity(const DeviceFacts& device) {
  const LaunchShape shape = untuned_shape(device);
  const ProgramSource source = calibration_program(shape);
  std::uint64_t hash = fnv1a(fmt::format("{} {}", kGroupsPerUnit, source.options));
  std::istringstream lines(pruned(source.text).text);
  std::string code;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("#line")) code += line + "\n";
  for (const Token& token : tokens_of(code)) hash = fnv1a(" ", fnv1a(token.text, hash));
  return fmt::format("{:016x}", hash);
}

double Calibration::run() {
  const auto start = Clock::now();
  const double seconds = checked([&] {
    kernel_.setArg(0, salt_++);
    kernel_.setArg(1, out_);
    cl::Event event;
    device_.queue().enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange(items_),
                                         cl::NDRange(local_size_), nullptr, &event);
    event.wait();
    return event_seconds(event);
  });
  ++launches_;
  wall_s_ += std::chrono::duration<double>(Clock::now() - start).count();
  return seconds;
}

}  // namespace koksma
