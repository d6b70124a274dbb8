// One OpenCL device with its context and queue: choose, build, upload, launch, time with events.
#pragma once

#include <CL/opencl.hpp>  // with the CL_HPP_ definitions of CMakeLists.txt
#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "device/binaries.hpp"
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
  bool kept = false;   // its binary was kept by an earlier run
};

class Device {
 public:
  // selector: "" (PoCL where there is one, else the first device), "P:D" (indices of `koksma list
  // devices`) or a part of the platform's or the device's name, ignoring case. NoDeviceError when
  // there is none or nothing matches. Kept programs and the device's tuning are used unless
  // KOKSMA_KEPT=off; a tuning that is not usable is told on stderr.
  static Device choose(const std::string& selector);
  // The same beside what the caller does meanwhile, reading a catalog say: loading PoCL and its
  // LLVM takes 35 ms. get() gives the device or choose()'s error; the destructor waits, so that an
  // error meanwhile is told that much later.
  static std::future<Device> choose_beside(const std::string& selector);
  // A CPU device with fp64 for exact values: this one if it is such, else the first found;
  // NoDeviceError otherwise.
  static Device choose_exact(const Device& preferred);

  const DeviceFacts& facts() const { return facts_; }
  cl::Context& context() { return context_; }
  cl::CommandQueue& queue() { return queue_; }

  // Builds, or takes from the programs this object has built (by text and options), or from those
  // that an earlier run kept on disk (device/binaries.hpp). BuildError with the log.
  BuiltProgram build(const ProgramSource& source);
  // How many programs this object has built or loaded.
  std::size_t programs_built() const { return programs_.size(); }
  // Plans for this device get the default launch shapes, whatever was tuned.
  void forget_tuning() { facts_.tuning = nullptr; }

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
  cl::Program build_from_source(const ProgramSource& source);

  cl::Device device_;
  DeviceFacts facts_;
  cl::Context context_;
  cl::CommandQueue queue_;
  KeptPrograms kept_;
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
