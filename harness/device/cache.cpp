#include "device/cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace koksma {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

Json with_checksum(Json header, std::string_view bytes) {
  header["bytes"] = bytes.size();
  header["checksum"] = fmt::format("{:016x}", fnv1a(bytes));
  return header;
}

}  // namespace

std::string cache_folder() {
  // The base-directory specification: a relative path is to be ignored.
  const std::string cache = variable("XDG_CACHE_HOME"), home = variable("HOME");
  if (fs::path(cache).is_absolute()) return fmt::format("{}/koksma", cache);
  return fs::path(home).is_absolute() ? fmt::format("{}/.cache/koksma", home) : "";
}

bool keeping_is_on() { return variable("KOKSMA_KEPT") != "off"; }

std::uint64_t fnv1a(std::string_view text, std::uint64_t start) {
  std::uint64_t hash = start;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return hash;
}

std::optional<std::string> kept_file(const std::string& path, const Json& header) {
  std::ifstream file(path, std::ios::binary);
  std::string line, bytes;
  if (path.empty() || !std::getline(file, line)) return std::nullopt;
  bytes.assign(std::istreambuf_iterator<char>(file), {});
  if (Json::parse(line, nullptr, false) != with_checksum(header, bytes)) return std::nullopt;
  return bytes;
}

bool replace_file(const std::string& path, std::string_view text) {
  if (path.empty()) return false;
  std::error_code failed;
  fs::create_directories(fs::path(path).parent_path(), failed);
  const std::string temporary = fmt::format("{}.{}", path, getpid());
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  const bool whole = static_cast<bool>(file);
  failed.clear();
  if (whole) fs::rename(temporary, path, failed);
  const bool renamed = whole && !failed;
  if (!renamed) fs::remove(temporary, failed);
  return renamed;
}

void keep_file(const std::string& path, const Json& header, std::string_view bytes) {
  std::string text = dumped(with_checksum(header, bytes));
  text += '\n';
  text += bytes;
  replace_file(path, text);
}

}  // namespace koksma
