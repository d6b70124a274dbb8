#include "device/prepare.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace koksma {
namespace {

constexpr int kPointSetFormat = 2;
constexpr std::size_t kLaunchesAtOnce = 512;  // queued before the host waits

// All that decides the set.
std::string key_of(const PlannedPreparation& p) {
  std::string launches;
  for (const PreparationLaunch& launch : p.work.launches) {
    launches += fmt::format("{} {}", launch.kernel, launch.items);
    for (const std::uint64_t argument : launch.arguments) launches += fmt::format(" {}", argument);
    launches += '\n';
  }
  return fmt::format("{:016x}{:016x}", fnv1a(p.program.text), fnv1a(launches));
}

std::string bytes_of(const std::vector<double>& values) {
  std::string bytes;
  bytes.reserve(values.size() * 8);
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 64; shift += 8) bytes += static_cast<char>(bits >> shift);
  }
  return bytes;
}

Json header_of(const PlannedPreparation& p) {
  return {{"koksma_point_set", kPointSetFormat},
          {"preparation", p.work.piece},
          {"points", p.work.points},
          {"dimensions", p.work.dim},
          {"key", key_of(p)}};
}

using PreparedSet = std::shared_ptr<const std::vector<double>>;

// nullptr when there is no such file, or one that is not what it should be.
PreparedSet load(const PlannedPreparation& p, const std::string& path) {
  const auto kept = kept_file(path, header_of(p));
  if (!kept || kept->size() != p.work.points * p.work.dim * 8) return nullptr;
  const std::string& bytes = *kept;
  auto values = std::make_shared<std::vector<double>>();
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t bits = 0;
    for (std::size_t i = 8; i-- > 0;) bits = bits << 8 | static_cast<unsigned char>(bytes[at + i]);
    values->push_back(std::bit_cast<double>(bits));
  }
  return values;
}

void save(const PlannedPreparation& p, const std::string& path, const std::vector<double>& values) {
  keep_file(path, header_of(p), bytes_of(values));
}

void enqueue(Device& device, const std::vector<cl::Buffer>& buffers, cl::Kernel& kernel,
             const PreparationLaunch& launch, std::uint64_t local) {
  cl_uint arg = 0;
  for (const cl::Buffer& buffer : buffers) kernel.setArg(arg++, buffer);
  for (const std::uint64_t argument : launch.arguments) kernel.setArg(arg++, cl_ulong{argument});
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange,
                                      cl::NDRange((launch.items + local - 1) / local * local),
                                      cl::NDRange(local));
}

PreparedSet compute(Device& device, const PlannedPreparation& p) {
  const BuiltProgram built = device.build(p.program);
  const std::uint64_t values = p.work.points * p.work.dim;
  std::vector<std::uint64_t> sizes{(values + 1) * 8};
  sizes.insert(sizes.end(), p.work.other_buffers.begin(), p.work.other_buffers.end());
  std::vector<std::uint64_t> words(values + 1);
  checked([&] {
    std::vector<cl::Buffer> buffers;
    for (const std::uint64_t size : sizes)
      buffers.push_back(device.upload(std::vector<std::byte>(size).data(), size));
    std::map<std::string, cl::Kernel> kernels;
    std::size_t queued = 0;
    for (const PreparationLaunch& launch : p.work.launches) {
      auto [found, is_new] = kernels.try_emplace(launch.kernel);
      if (is_new) found->second = cl::Kernel(built.program, launch.kernel);
      enqueue(device, buffers, found->second, launch, p.local_size);
      if (++queued % kLaunchesAtOnce == 0) device.queue().finish();
    }
    device.queue().enqueueReadBuffer(buffers[0], CL_TRUE, 0, words.size() * 8, words.data());
  });
  if (words.back() != p.work.points)
    throw std::runtime_error(
        fmt::format("{} made {} points of {}", p.program.name, words.back(), p.work.points));
  auto set = std::make_shared<std::vector<double>>();
  for (std::uint64_t i = 0; i < values; ++i)
    set->push_back(std::ldexp(static_cast<double>(words[i] >> 12), -52));
  return set;
}

}  // namespace

std::string cache_file(const PlannedPreparation& preparation) {
  const std::string folder = cache_folder();
  return folder.empty() ? ""
                        : fmt::format("{}/{}-{}-{}.points", folder, preparation.work.piece,
                                      preparation.work.points, key_of(preparation));
}

std::vector<std::byte> point_table(Device& device, const Plan& plan, std::uint64_t n) {
  if (!plan.preparation) return build_point_table(plan, n);
  const PlannedPreparation& preparation = *plan.preparation;
  PreparedSet& set = device.prepared()[key_of(preparation)];
  if (set == nullptr) {
    const std::string path = cache_file(preparation);
    set = load(preparation, path);
    if (set == nullptr) {
      set = compute(device, preparation);
      save(preparation, path, *set);
    }
  }
  return build_point_table(plan, n, set);
}

}  // namespace koksma
