// Kernels of kernels/stability/ with numbers that reach the device as arguments.
#pragma once

#include <string>
#include <vector>

#include "device/device.hpp"
#include "estimate/exact_sum.hpp"

namespace koksma {

// One program: a piece of kernels/stability/ and sums, as they are, under these build options.
class SelfTestProgram {
 public:
  // BuildError, DeviceError. Vectors are as wide as those of the integration kernel.
  SelfTestProgram(Device& device, const std::string& piece, std::vector<const SumAlgorithm*> sums,
                  Precision precision, const std::string& options);

  // One work-item of kernel `name` with these scalars, rounded to the precision, and `count`
  // results.
  std::vector<double> call(const std::string& name, const std::vector<double>& scalars,
                           std::size_t count);

  // What sum k makes of terms[0], terms[1], …, in this order and repeated to n terms: the exact sum
  // of its words. One NaN where the lanes, which all add the same, differ.
  ExactSum add_up(std::size_t k, const std::vector<double>& terms, std::uint32_t n);

 private:
  std::vector<double> run(cl::Kernel& kernel, cl_uint out_arg, std::size_t count, bool doubles);

  Device& device_;
  std::vector<const SumAlgorithm*> sums_;
  bool fp64_;
  std::uint32_t lanes_;
  cl::Program program_;
};

}  // namespace koksma
