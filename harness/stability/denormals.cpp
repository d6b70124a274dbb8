#include "stability/denormals.hpp"

#include <fmt/format.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>

#include "stability/eft.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

// The five words of kernels/stability/denormals.cl.
template <typename Real, typename Word>
void try_denormals(Device& device, const std::string& options, Real factor, Real denormal,
                   DenormalResult& result) {
  std::vector<Word> out(5);
  checked([&] {
    cl::Kernel kernel(
        device.build(self_test_program("denormals", {}, result.precision, 1, options)).program,
        "denormals");
    kernel.setArg(0, factor);
    kernel.setArg(1, factor);
    kernel.setArg(2, Real{0});
    kernel.setArg(3, Real{1});
    const cl::Buffer x = device.upload(&denormal, sizeof denormal);
    kernel.setArg(4, x);
    const cl::Buffer words = device.allocate(out.size() * sizeof(Word));
    kernel.setArg(5, words);
    device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    return device.queue().enqueueReadBuffer(words, CL_TRUE, 0, out.size() * sizeof(Word),
                                            out.data());
  });
  const Word kept = std::bit_cast<Word>(denormal);
  result.product_flushed = out[0] != std::bit_cast<Word>(factor * factor);
  result.operand_flushed = out[1] != kept || out[2] != kept;
  result.compared_as_zero = out[3] == 0 || out[4] == 0;
}

}  // namespace

DenormalChecks check_denormals(Device& device) {
  const auto start = Clock::now();
  DenormalChecks result;
  result.fp_config_fp32 = device.facts().fp_config32;
  result.fp_config_fp64 = device.facts().fp_config64;
  for (const char* options : {"", "-cl-denorms-are-zero", kRelaxedMathOption}) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      if (precision == Precision::fp64 && !device.facts().fp64) continue;
      DenormalResult one;
      one.options = options;
      one.precision = precision;
      const DeviceFacts& facts = device.facts();
      const auto& config = precision == Precision::fp64 ? facts.fp_config64 : facts.fp_config32;
      one.must_keep = one.options.empty() && config.find("DENORM") != std::string::npos;
      // Factors of a product just below the normal range, whose bits the host knows.
      if (precision == Precision::fp64)
        try_denormals<cl_double, std::uint64_t>(device, options, 1e-160, 0x1.8p-1070, one);
      else
        try_denormals<cl_float, std::uint32_t>(device, options, 1e-20F, 0x1.8p-140F, one);
      if (one.must_keep && one.flushed() && result.why.empty())
        result.why = fmt::format(
            "{} denormals are flushed under strict options, although the device "
            "reports them",
            precision_name(precision));
      result.results.push_back(one);
    }
  }
  result.ok = result.why.empty();
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace koksma
