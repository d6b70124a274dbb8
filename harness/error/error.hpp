// The three kinds of failure, split by who is at fault: the user's input, a kernel that does not
// compile, the OpenCL implementation. Exit status of main: InputError 2, DeviceError without a
// usable device 3, else 1.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace koksma {

// The user's input is wrong: where (file, JSON pointer, flag), what was found, what is allowed.
class InputError : public std::runtime_error {
 public:
  InputError(std::string_view where, std::string_view found, std::string_view allowed);
};

// A kernel program does not build; the message holds the compiler's log with file and line of the
// .cl.
class BuildError : public std::runtime_error {
 public:
  BuildError(std::string_view program, std::string_view log);
};

// An OpenCL call failed.
class DeviceError : public std::runtime_error {
 public:
  DeviceError(std::string_view call, int code);
};

// There is no device to run on: no platform, or a selector that matches nothing.
class NoDeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A cell asks for something this device or sampler lacks; the cell becomes a row with status
// "unsupported".
class UnsupportedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The OpenCL name of an error code ("CL_OUT_OF_RESOURCES"), or its number when unknown.
std::string error_code_name(int code);

// The candidate nearest to `name` by edit distance, "" when none is near (distance above a third of
// the length).
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

// InputError for a name that is none of `known`: lists them and suggests the nearest.
InputError unknown_name(std::string_view where, std::string_view kind, std::string_view name,
                        const std::vector<std::string>& known);

}  // namespace koksma
