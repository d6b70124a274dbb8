// Peer: Intel oneMKL's vector statistics. mkl sobol|philox fp32|fp64
// The Sobol' stream is one set of points (VSL_BRNG_SOBOL); Philox4x32-10 streams have one key a
// replicate. Streams fill cache-sized blocks, as its documentation recommends.
#include <mkl_vsl.h>

#include "worker.hpp"

namespace {

template <typename Real>
void uniform(VSLStreamStatePtr stream, Real* x, std::size_t count) {
  const int n = static_cast<int>(count);
  if constexpr (sizeof(Real) == 4) vsRngUniform(VSL_RNG_METHOD_UNIFORM_STD, stream, n, x, 0.0f, 1.0f);
  else vdRngUniform(VSL_RNG_METHOD_UNIFORM_STD, stream, n, x, 0.0, 1.0);
}

template <typename Real>
int serve(bool sobol) {
  return peer::serve([sobol](const peer::Job& job, unsigned replicate) {
    VSLStreamStatePtr stream = nullptr;
    const auto seed = static_cast<MKL_UINT>(sobol ? peer::kDim : job.seed * 65536 + replicate);
    if (vslNewStream(&stream, sobol ? VSL_BRNG_SOBOL : VSL_BRNG_PHILOX4X32X10, seed) != VSL_STATUS_OK)
      throw std::runtime_error("vslNewStream failed");
    const double mean = peer::blockwise_mean<Real>(job, [&](Real* x, std::uint64_t, std::size_t count) {
      uniform(stream, x, count * peer::kDim);
    });
    vslDeleteStream(&stream);
    return mean;
  });
}

}  // namespace

int main(int, char** argv) {
  const bool sobol = std::string(argv[1]) == "sobol";
  return std::string(argv[2]) == "fp32" ? serve<float>(sobol) : serve<double>(sobol);
}
