// The kernels of kernels/quality/ on one device: point columns, launches, results as doubles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/device.hpp"

namespace koksma {

// Points in [0,1)^dim as they were drawn.
struct PointSet {
  std::uint32_t dim = 1;
  std::vector<double> x;  // [point][dimension]

  std::uint64_t size() const { return x.size() / dim; }
  double at(std::uint64_t point, std::uint32_t dimension) const {
    return x[point * dim + dimension];
  }
};

class QualityKernels {
 public:
  // fp64 false: all arithmetic of the kernels in fp32, for a device without fp64.
  QualityKernels(Device& device, bool fp64);

  bool fp64() const { return fp64_; }
  Device& device() { return device_; }
  std::uint32_t lanes() const { return shape_.lanes_per_item; }
  // Points of a column, rounded up to whole vectors.
  std::uint32_t padded(std::uint64_t n) const;
  // [dimension][point] of values given as [point][dimension]; padding points are `padding`.
  cl::Buffer columns(const PointSet& points, double padding);
  // One scalar per value.
  cl::Buffer upload(const std::vector<double>& values) {
    return device_.upload_reals(values, fp64_);
  }
  cl::Buffer upload_words(const std::vector<std::uint32_t>& words) {
    return device_.upload(words.data(), words.size() * sizeof(std::uint32_t));
  }
  cl::Buffer scalars(std::uint64_t count) { return device_.allocate(count * (fp64_ ? 8 : 4)); }
  std::vector<double> read(const cl::Buffer& buffer, std::uint64_t count);
  std::vector<std::uint32_t> read_words(const cl::Buffer& buffer, std::uint64_t count);

  // Runs `items` work-items of a kernel: buffers, cl_uint and cl_ulong in the kernel's order.
  template <typename... Args>
  void run(const std::string& piece, const std::string& name, std::uint64_t items,
           const Args&... args) {
    checked([&] {
      cl::Kernel kernel = find(piece, name);
      cl_uint index = 0;
      (kernel.setArg(index++, args), ...);
      launch(kernel, items);
    });
  }

 private:
  cl::Kernel find(const std::string& piece, const std::string& name);
  void launch(const cl::Kernel& kernel, std::uint64_t items);

  Device& device_;
  bool fp64_;
  LaunchShape shape_;
};

}  // namespace koksma
