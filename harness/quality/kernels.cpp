#include "quality/kernels.hpp"

#include <algorithm>

#include "plan/untuned_shape.hpp"

namespace koksma {

QualityKernels::QualityKernels(Device& device, bool fp64)
    : device_(device), fp64_(fp64), shape_(untuned_shape(device.facts())) {}

std::uint32_t QualityKernels::padded(std::uint64_t n) const {
  const std::uint64_t lanes = shape_.lanes_per_item;
  return static_cast<std::uint32_t>((n + lanes - 1) / lanes * lanes);
}

cl::Buffer QualityKernels::columns(const PointSet& points, double padding) {
  const std::uint64_t length = padded(points.size());
  std::vector<double> values(length * points.dim, padding);
  for (std::uint64_t i = 0; i < points.size(); ++i)
    for (std::uint32_t j = 0; j < points.dim; ++j) values[j * length + i] = points.at(i, j);
  return upload(values);
}

std::vector<double> QualityKernels::read(const cl::Buffer& buffer, std::uint64_t count) {
  std::vector<double> values(count);
  std::vector<float> narrow(fp64_ ? 0 : count);
  void* target = fp64_ ? static_cast<void*>(values.data()) : narrow.data();
  checked([&] {
    return device_.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * (fp64_ ? 8 : 4), target);
  });
  std::copy(narrow.begin(), narrow.end(), values.begin());
  return values;
}

std::vector<std::uint32_t> QualityKernels::read_words(const cl::Buffer& buffer,
                                                      std::uint64_t count) {
  std::vector<std::uint32_t> words(count);
  checked([&] {
    return device_.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(std::uint32_t),
                                             words.data());
  });
  return words;
}

cl::Kernel QualityKernels::find(const std::string& piece, const std::string& name) {
  return {device_.build(quality_program(piece, fp64_, shape_)).program, name.c_str()};
}

void QualityKernels::launch(const cl::Kernel& kernel, std::uint64_t items) {
  const std::uint64_t local = shape_.local_size;
  device_.queue().enqueueNDRangeKernel(
      kernel, cl::NullRange, cl::NDRange((items + local - 1) / local * local), cl::NDRange(local));
  device_.queue().finish();
}

}  // namespace koksma
