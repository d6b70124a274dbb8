#include "device/binaries.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "device/cache.hpp"

namespace koksma {
namespace {

namespace fs = std::filesystem;

constexpr int kProgramFormat = 1;
// About 3000 programs of PoCL's; beyond it the oldest go.
constexpr std::uintmax_t kMostBytes = std::uintmax_t{256} << 20;

// Two hashes of the same text, from different starts: 128 bits together.
std::string hash_of(const std::string& text) {
  return fmt::format("{:016x}{:016x}", fnv1a(text), fnv1a(text, 0x9E3779B97F4A7C15U));
}

// Removes the files that were written first until the folder is half full.
void make_room(const std::string& folder) {
  struct Kept {
    fs::file_time_type written;
    std::uintmax_t bytes;
    fs::path path;
  };
  std::vector<Kept> files;
  std::uintmax_t total = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    files.push_back({entry.last_write_time(ignored), entry.file_size(ignored), entry.path()});
    total += files.back().bytes;
  }
  if (total <= kMostBytes) return;
  std::sort(files.begin(), files.end(),
            [](const Kept& a, const Kept& b) { return a.written < b.written; });
  for (const Kept& kept : files) {
    if (total <= kMostBytes / 2) break;
    fs::remove(kept.path, ignored);
    total -= kept.bytes;
  }
}

}  // namespace

KeptPrograms::KeptPrograms(std::string folder, std::string device)
    : folder_(std::move(folder)), device_(std::move(device)) {
  if (!folder_.empty()) make_room(folder_);
}

std::string KeptPrograms::file(const ProgramSource& source) const {
  if (folder_.empty()) return "";
  const std::string all = fmt::format("{}\n{}\n{}", device_, source.options, source.text);
  return fmt::format("{}/{}.program", folder_, hash_of(all));
}

// A file that was renamed, or is another program's, does not match it.
Json KeptPrograms::header(const ProgramSource& source) const {
  return {{"koksma_program", kProgramFormat},
          {"device", device_},
          {"options", source.options},
          {"text", hash_of(source.text)}};
}

std::optional<cl::Program> KeptPrograms::find(const cl::Context& context, const cl::Device& device,
                                              const ProgramSource& source) const {
  const auto bytes = kept_file(file(source), header(source));
  if (!bytes || bytes->empty()) return std::nullopt;
  try {
    const std::vector<unsigned char> binary(bytes->begin(), bytes->end());
    cl::Program program(context, {device}, {binary});
    program.build(device, source.options.c_str());
    return program;
  } catch (const cl::Error&) {  // another build of the driver, perhaps: the source is at hand
    return std::nullopt;
  }
}

void KeptPrograms::keep(const cl::Program& program, const ProgramSource& source) const {
  if (folder_.empty()) return;
  try {
    const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.size() != 1 || binaries.front().empty()) return;
    const std::string bytes(binaries.front().begin(), binaries.front().end());
    keep_file(file(source), header(source), bytes);
  } catch (const cl::Error&) {  // a driver that hands out none
  }
}

}  // namespace koksma
