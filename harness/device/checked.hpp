// Turns the C++ bindings' exceptions into DeviceError, which names the OpenCL call and its error
// code.
#pragma once

#include "device/device.hpp"
#include "error/error.hpp"

namespace koksma {

template <typename Call>
auto checked(Call&& call) -> decltype(call()) {
  try {
    return call();
  } catch (const cl::Error& error) {
    throw DeviceError(error.what(), error.err());
  }
}

}  // namespace koksma
