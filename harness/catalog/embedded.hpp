// The files of kernels/, integrands/ and the JSON schemas, embedded by CMake (scripts/embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace koksma {

struct EmbeddedFile {
  std::string_view path;  // relative to the repository's root
  std::string_view text;
};

// All embedded files, sorted by path.
std::span<const EmbeddedFile> embedded_files();

// The text of one embedded file; std::out_of_range if there is none (our own bug, not input).
std::string_view embedded_text(std::string_view path);

}  // namespace koksma
