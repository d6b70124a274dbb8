// The user's cache folder, and files in it that are believed only when whole: one line of JSON that
// says what the file is, with a checksum, then the bytes. All of it is safe to delete at any time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "catalog/json.hpp"

namespace koksma {

// $XDG_CACHE_HOME/koksma, or ~/.cache/koksma; "" where neither is known.
std::string cache_folder();

// Whether programs and tunings are to be kept, and used: not with KOKSMA_KEPT=off.
bool keeping_is_on();

// FNV-1a (Fowler, Noll & Vo): tells damage from health and texts apart; no defence against malice.
std::uint64_t fnv1a(std::string_view text, std::uint64_t start = 0xCBF29CE484222325U);

// The bytes of a file that keep_file() wrote with this header; empty when there is none, or one
// that is cut short, damaged or something else.
std::optional<std::string> kept_file(const std::string& path, const Json& header);

// Writes it under a name of this process's first, so that no reader meets a part of it; whoever
// renames last wins. A folder that cannot be written is no failure, nor is the path "".
void keep_file(const std::string& path, const Json& header, std::string_view bytes);

// The same for text without a header; false where it could not be written.
bool replace_file(const std::string& path, std::string_view text);

}  // namespace koksma
