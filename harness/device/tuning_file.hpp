// Where `koksma tune` keeps what it measured: one JSON file per device and driver in the user's
// cache folder (schema: tuning.schema.json), safe to delete.
#pragma once

#include <memory>
#include <string>

#include "plan/tuning.hpp"

namespace koksma {

// $XDG_CACHE_HOME/koksma/tuning-<device and driver>.json; "" without a cache folder.
std::string tuning_file(const DeviceFacts& device);

// What the file says, nullptr where there is none. InputError when it is damaged, or stale: of
// another device, driver or number of compute units, or of other kernels than these.
std::shared_ptr<const Tuning> read_tuning(const DeviceFacts& device);

// read_tuning(), but a file that can not be used is told in one line on stderr and ignored.
std::shared_ptr<const Tuning> usable_tuning(const DeviceFacts& device);

// Writes the file; false where it could not be written.
bool write_tuning(const DeviceFacts& device, const Tuning& tuning);

}  // namespace koksma
