// One OpenCL device with its context and queue: choose, build, upload, launch, time with events.
#pragma once

#include <CL/opencl.hpp>  // with the CL_HPP_ definitions of CMakeLists.txt
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plan/plan.hpp"

namespace koksma {

struct DeviceListing {
  int platform = 0, device = 0;
  DeviceFacts facts;
};

// Every device of every platform; empty when there is no OpenCL platform.
std::vector<DeviceListing> list_devices();

// A built program and what building cost.
struct BuiltProgram {
  cl::Program program;
  double build_s = 0;  // 0 when it was memoised
};

class Device {
 public:
  // selector: "" (PoCL where there is one, else the first device), "P:D" (indices of `koksma list
  // devices`) or a part of the platform's or the device's name, ignoring case. NoDeviceError when
  // there is none or nothing matches.
  static Device choose(const std::string& selector);
  // A CPU device with fp64 for exact values: this one if it is such, else the first found;
  // NoDeviceError otherwise.
  static Device choose_exact(const Device& preferred);

  const DeviceFacts& facts() const { return facts_; }
  cl::Context& context() { return context_; }
  cl::CommandQueue& queue() { return queue_; }

  // Builds, or takes from the programs this object has built (by text and options). BuildError with
  // the log.
  BuiltProgram build(const ProgramSource& source);

  // Point sets that preparations have computed through this object, by key (device/prepare.hpp).
  std::map<std::string, std::shared_ptr<const std::vector<double>>>& prepared() {
    return prepared_;
  }

  // A read-only buffer with these bytes (at least 8 are allocated).
  cl::Buffer upload(const void* data, std::size_t bytes);
  cl::Buffer allocate(std::size_t bytes);
  // Doubles rounded to fp32 unless fp64.
  cl::Buffer upload_reals(const std::vector<double>& values, bool fp64);

 private:
  Device(cl::Device device, DeviceFacts facts);

  cl::Device device_;
  DeviceFacts facts_;
  cl::Context context_;
  cl::CommandQueue queue_;
  std::map<std::string, cl::Program> programs_;
  std::map<std::string, std::shared_ptr<const std::vector<double>>> prepared_;
};

// Seconds between start and end of a finished event.
double event_seconds(const cl::Event& event);

// Runs `call` and turns cl::Error into DeviceError.
template <typename Call>
auto checked(Call&& call) -> decltype(call());

}  // namespace koksma

#include "device/checked.hpp"
