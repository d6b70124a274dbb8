// What `koksma compare` reads from the contexts of two results files.
#pragma once

#include <string>
#include <vector>

#include "report/compare.hpp"

namespace koksma {

bool same_device(const Json& base, const Json& now);

// Whether calibrations are times of the same kernel. Results of before that was written down are
// taken for it where they are of the same revision.
bool same_calibration(const Json& base, const Json& now);

// What differs: device, driver, host, seed, ...
std::vector<std::string> context_notes(const Json& base, const Json& now,
                                       const CompareOptions& options);

}  // namespace koksma
