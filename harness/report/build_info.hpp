// What was built, for the results' context. Defined in a file that CMake generates.
#pragma once

#include <string>

namespace koksma {

struct BuildInfo {
  std::string version, revision, build_type, compiler;
};

BuildInfo build_info();

}  // namespace koksma
