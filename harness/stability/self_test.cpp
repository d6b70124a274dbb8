#include "stability/self_test.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace koksma {
namespace {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace

SelfTestProgram::SelfTestProgram(Device& device, const std::string& piece,
                                 std::vector<const SumAlgorithm*> sums, Precision precision,
                                 const std::string& options)
    : device_(device),
      sums_(std::move(sums)),
      fp64_(precision == Precision::fp64),
      lanes_(device.facts().is_cpu ? 16 : 1),
      program_(device.build(self_test_program(piece, sums_, precision, lanes_, options)).program) {}

std::vector<double> SelfTestProgram::call(const std::string& name,
                                          const std::vector<double>& scalars, std::size_t count) {
  return checked([&] {
    cl::Kernel kernel(program_, name.c_str());
    cl_uint arg = 0;
    for (const double value : scalars) {
      if (fp64_)
        kernel.setArg(arg++, cl_double{value});
      else
        kernel.setArg(arg++, static_cast<cl_float>(value));
    }
    return run(kernel, arg, count, fp64_);
  });
}

ExactSum SelfTestProgram::add_up(std::size_t k, const std::vector<double>& terms, std::uint32_t n) {
  return checked([&] {
    cl::Kernel kernel(program_, fmt::format("add_up_{}", k).c_str());
    const cl::Buffer buffer = device_.upload_reals(terms, fp64_);  // an argument does not keep it
    kernel.setArg(0, buffer);
    kernel.setArg(1, static_cast<cl_uint>(terms.size()));
    kernel.setArg(2, cl_uint{n});
    const SumAlgorithm& sum = *sums_[k];
    const unsigned words = sum.words(fp64_);
    const std::vector<double> stored =
        run(kernel, 3, std::size_t{words} * lanes_, fp64_ || sum.needs_fp64);
    ExactSum total;
    for (unsigned word = 0; word < words; ++word) {
      const double first = stored[std::size_t{word} * lanes_];
      total.add_scaled(first, sum.word_exponent(fp64_, word));
      for (std::size_t lane = 1; lane < lanes_; ++lane)
        if (!same_bits(first, stored[std::size_t{word} * lanes_ + lane])) total.add(NAN);
    }
    return total;
  });
}

std::vector<double> SelfTestProgram::run(cl::Kernel& kernel, cl_uint out_arg, std::size_t count,
                                         bool doubles) {
  const cl::Buffer out = device_.allocate(count * 8);
  kernel.setArg(out_arg, out);
  cl::CommandQueue& queue = device_.queue();
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
  std::vector<double> result(count);
  if (doubles) {
    queue.enqueueReadBuffer(out, CL_TRUE, 0, count * sizeof(double), result.data());
    return result;
  }
  std::vector<float> narrow(count);
  queue.enqueueReadBuffer(out, CL_TRUE, 0, count * sizeof(float), narrow.data());
  return {narrow.begin(), narrow.end()};
}

}  // namespace koksma
