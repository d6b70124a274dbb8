#include "device/device.hpp"

#include <fmt/format.h>
#include <signal.h>  // sigaltstack

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <utility>

#include "device/cache.hpp"
#include "device/tuning_file.hpp"

namespace koksma {
namespace {

constexpr const char* kPoclPlatform = "Portable Computing Language";

std::vector<cl::Platform> platforms() {
  std::vector<cl::Platform> found;
  try {
    cl::Platform::get(&found);
  } catch (const cl::Error&) {
    return {};  // the loader's way of saying that there is none
  }
  return found;
}

std::vector<cl::Device> devices_of(const cl::Platform& platform) {
  std::vector<cl::Device> found;
  try {
    platform.getDevices(CL_DEVICE_TYPE_ALL, &found);
  } catch (const cl::Error&) {
    return {};
  }
  return found;
}

// Some drivers hand out strings with a trailing NUL or blanks.
std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

std::string fp_config_text(cl_device_fp_config config) {
  std::string text;
  for (const auto& [flag, name] :
       {std::pair<cl_device_fp_config, const char*>{CL_FP_DENORM, "DENORM"},
        {CL_FP_INF_NAN, "INF_NAN"},
        {CL_FP_ROUND_TO_NEAREST, "ROUND_TO_NEAREST"},
        {CL_FP_ROUND_TO_ZERO, "ROUND_TO_ZERO"},
        {CL_FP_ROUND_TO_INF, "ROUND_TO_INF"},
        {CL_FP_FMA, "FMA"},
        {CL_FP_SOFT_FLOAT, "SOFT_FLOAT"},
        {CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, "CORRECTLY_ROUNDED_DIVIDE_SQRT"}})
    if ((config & flag) != 0) text += fmt::format("{}{}", text.empty() ? "" : "|", name);
  return text;
}

DeviceFacts facts_of(const cl::Platform& platform, const cl::Device& device) {
  DeviceFacts f;
  f.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
  f.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
  f.vendor = trimmed(device.getInfo<CL_DEVICE_VENDOR>());
  f.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
  f.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
  f.is_cpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  f.fp64 = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  f.fp_config32 = fp_config_text(device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>());
  f.fp_config64 = fp_config_text(device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>());
  f.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  f.max_work_group_size = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  f.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  return f;
}

// All that a binary depends on besides the program: PoCL's platform version names its LLVM.
std::string binary_identity(const cl::Device& device, const DeviceFacts& facts) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  return fmt::format("{}|{}|{}|{}|{}|{}", facts.platform,
                     trimmed(platform.getInfo<CL_PLATFORM_VERSION>()), facts.vendor, facts.name,
                     facts.version, facts.driver);
}

struct Candidate {
  int platform_index, device_index;
  cl::Device device;
  DeviceFacts facts;
};

// Unpinned, PoCL's threads may share one core of a busy machine for seconds, and times double
// (measured). A setting of the user's stands.
void pin_pocl_threads() { setenv("POCL_AFFINITY", "1", 0); }

// LLVM, which PoCL loads, gives the thread that loads it a signal stack. A thread that ends gets
// its own back, which AddressSanitizer takes down.
class OwnSignalStack {
 public:
  OwnSignalStack() { sigaltstack(nullptr, &own_); }
  ~OwnSignalStack() { sigaltstack(&own_, nullptr); }
  OwnSignalStack(const OwnSignalStack&) = delete;
  OwnSignalStack& operator=(const OwnSignalStack&) = delete;

 private:
  stack_t own_{};
};

std::vector<Candidate> candidates() {
  pin_pocl_threads();
  std::vector<Candidate> found;
  const auto all = platforms();
  for (std::size_t p = 0; p < all.size(); ++p) {
    const auto devices = devices_of(all[p]);
    for (std::size_t d = 0; d < devices.size(); ++d)
      found.push_back(
          {static_cast<int>(p), static_cast<int>(d), devices[d], facts_of(all[p], devices[d])});
  }
  return found;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool matches(const Candidate& c, const std::string& selector) {
  if (selector == fmt::format("{}:{}", c.platform_index, c.device_index)) return true;
  const std::string wanted = lower(selector);
  return lower(c.facts.name).find(wanted) != std::string::npos ||
         lower(c.facts.platform).find(wanted) != std::string::npos;
}

std::string describe(const std::vector<Candidate>& all) {
  std::string text;
  for (const Candidate& c : all)
    text += fmt::format("\n  {}:{}  {} ({})", c.platform_index, c.device_index, c.facts.name,
                        c.facts.platform);
  return text;
}

}  // namespace

std::vector<DeviceListing> list_devices() {
  std::vector<DeviceListing> result;
  for (const Candidate& c : candidates())
    result.push_back({c.platform_index, c.device_index, c.facts});
  return result;
}

Device::Device(cl::Device device, DeviceFacts facts)
    : device_(std::move(device)),
      facts_(std::move(facts)),
      context_(device_),
      queue_(context_, device_, cl::QueueProperties::Profiling) {
  const std::string folder = keeping_is_on() ? cache_folder() : "";
  if (!folder.empty())
    kept_ = KeptPrograms(fmt::format("{}/programs", folder), binary_identity(device_, facts_));
}

Device Device::choose(const std::string& selector) {
  const auto all = candidates();
  if (all.empty())
    throw NoDeviceError(
        "no OpenCL device: no platform is installed; on Debian: apt-get install pocl-opencl-icd");
  auto chosen =
      selector.empty()
          ? std::find_if(all.begin(), all.end(),
                         [](const Candidate& c) { return c.facts.platform == kPoclPlatform; })
          : std::find_if(all.begin(), all.end(),
                         [&](const Candidate& c) { return matches(c, selector); });
  if (chosen == all.end() && !selector.empty())
    throw NoDeviceError(
        fmt::format("--device: '{}' matches no device; there are (P:D, name, platform):{}",
                    selector, describe(all)));
  if (chosen == all.end()) chosen = all.begin();
  DeviceFacts facts = chosen->facts;
  if (keeping_is_on()) facts.tuning = usable_tuning(facts);
  return checked([&] { return Device(chosen->device, std::move(facts)); });
}

std::future<Device> Device::choose_beside(const std::string& selector) {
  pin_pocl_threads();  // here: the environment is not written while another thread reads it
  return std::async(std::launch::async, [selector] {
    const OwnSignalStack own;
    return choose(selector);
  });
}

Device Device::choose_exact(const Device& preferred) {
  if (preferred.facts_.is_cpu && preferred.facts_.fp64) return preferred;
  const auto all = candidates();
  const auto chosen = std::find_if(
      all.begin(), all.end(), [](const Candidate& c) { return c.facts.is_cpu && c.facts.fp64; });
  if (chosen == all.end())
    throw NoDeviceError(
        "exact values need a CPU device with fp64 and there is none; on Debian: apt-get install "
        "pocl-opencl-icd");
  return checked([&] { return Device(chosen->device, chosen->facts); });
}

BuiltProgram Device::build(const ProgramSource& source) {
  const std::string key = source.options + "\n" + source.text;
  if (const auto found = programs_.find(key); found != programs_.end()) return {found->second, 0};
  const auto start = std::chrono::steady_clock::now();
  std::optional<cl::Program> kept = kept_.find(context_, device_, source);
  const cl::Program program = kept ? *kept : build_from_source(source);
  if (!kept) kept_.keep(program, source);
  programs_.emplace(key, program);
  return {program, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          kept.has_value()};
}

cl::Program Device::build_from_source(const ProgramSource& source) {
  cl::Program program = checked([&] { return cl::Program(context_, source.text); });
  try {
    program.build(device_, source.options.c_str());
  } catch (const cl::Error& error) {
    if (error.err() != CL_BUILD_PROGRAM_FAILURE) throw DeviceError(error.what(), error.err());
    throw BuildError(source.name, program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_));
  }
  return program;
}

cl::Buffer Device::upload(const void* data, std::size_t bytes) {
  cl::Buffer buffer = allocate(bytes);
  if (bytes > 0)
    checked([&] { return queue_.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data); });
  return buffer;
}

cl::Buffer Device::allocate(std::size_t bytes) {
  return checked(
      [&] { return cl::Buffer(context_, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 8)); });
}

cl::Buffer Device::upload_reals(const std::vector<double>& values, bool fp64) {
  if (fp64) return upload(values.data(), values.size() * sizeof(double));
  const std::vector<float> narrow(values.begin(), values.end());
  return upload(narrow.data(), narrow.size() * sizeof(float));
}

double event_seconds(const cl::Event& event) {
  const auto start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
  const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
  return static_cast<double>(end - start) * 1e-9;
}

}  // namespace koksma
