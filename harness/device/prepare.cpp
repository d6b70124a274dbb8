#include "device/prepare.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace koksma {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 1;
constexpr std::size_t kLaunchesAtOnce = 512;  // queued before the host waits

// FNV-1a (Fowler, Noll & Vo): tells damage from health and texts apart; no defence against malice.
std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return hash;
}

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

Json header_of(const PlannedPreparation& p, std::string_view bytes) {
  return {{"koksma_point_set", kFormat},
          {"preparation", p.work.piece},
          {"points", p.work.points},
          {"dimensions", p.work.dim},
          {"key", key_of(p)},
          {"checksum", fmt::format("{:016x}", fnv1a(bytes))}};
}

using PointSet = std::shared_ptr<const std::vector<double>>;

// nullptr when there is no such file, or one that is not what it should be.
PointSet load(const PlannedPreparation& p, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string header, bytes;
  if (path.empty() || !std::getline(file, header)) return nullptr;
  bytes.assign(std::istreambuf_iterator<char>(file), {});
  if (bytes.size() != p.work.points * p.work.dim * 8) return nullptr;
  if (Json::parse(header, nullptr, false) != header_of(p, bytes)) return nullptr;
  auto values = std::make_shared<std::vector<double>>();
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t bits = 0;
    for (std::size_t i = 8; i-- > 0;) bits = bits << 8 | static_cast<unsigned char>(bytes[at + i]);
    values->push_back(std::bit_cast<double>(bits));
  }
  return values;
}

// Under a name of this process's until it is whole; whoever renames last has written the same.
void save(const PlannedPreparation& p, const std::string& path, const std::vector<double>& values) {
  if (path.empty()) return;
  std::error_code ignored;
  fs::create_directories(fs::path(path).parent_path(), ignored);
  const std::string temporary = fmt::format("{}.{}", path, getpid());
  const std::string bytes = bytes_of(values);
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file << header_of(p, bytes).dump() << '\n' << bytes;
  file.close();
  if (file) fs::rename(temporary, path, ignored);
  fs::remove(temporary, ignored);
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

PointSet compute(Device& device, const PlannedPreparation& p) {
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

std::string cache_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  // The base-directory specification: a relative path is to be ignored.
  const std::string cache = variable("XDG_CACHE_HOME"), home = variable("HOME");
  if (fs::path(cache).is_absolute()) return cache + "/koksma";
  return fs::path(home).is_absolute() ? home + "/.cache/koksma" : "";
}

std::string cache_file(const PlannedPreparation& preparation) {
  const std::string folder = cache_folder();
  return folder.empty() ? ""
                        : fmt::format("{}/{}-{}-{}.points", folder, preparation.work.piece,
                                      preparation.work.points, key_of(preparation));
}

std::vector<std::byte> point_table(Device& device, const Plan& plan, std::uint64_t n) {
  if (!plan.preparation) return build_point_table(plan, n);
  const PlannedPreparation& preparation = *plan.preparation;
  PointSet& set = device.prepared()[key_of(preparation)];
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
