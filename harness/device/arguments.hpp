// What the files of the integrator share: kernel arguments in the precision of a cell.
#pragma once

#include "catalog/lanes.hpp"
#include "device/device.hpp"

namespace koksma {

// Sets a real argument: a double where `fp64`, else rounded to a float.
inline void set_real(cl::Kernel& kernel, cl_uint index, double value, bool fp64) {
  if (fp64)
    kernel.setArg(index, cl_double{value});
  else
    kernel.setArg(index, static_cast<cl_float>(value));
}

}  // namespace koksma
