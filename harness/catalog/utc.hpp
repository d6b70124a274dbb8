// The time of day as every file of koksma writes it.
#pragma once

#include <string>

namespace koksma {

// Now, in UTC, as ISO 8601: 2026-01-31T12:34:56Z.
std::string utc_now();

}  // namespace koksma
