// Hand-written AVX2 limits: what a person would write for exactly the work of one fused kernel, to
// measure the kernel against. Same points from the same table, same integrand prod_j (1 + c_j (x_j
// - 1/2)), same blocks, lanes and order of additions, sums in fp64; nothing that the kernel does
// per coordinate is merged or left out. Method: 3-kernels, points 2, 3 and 6; the table's layout is
// at the head of kernels/points/digital.cl.
#pragma once

#include <cstdint>
#include <vector>

namespace koksma::bench {

inline constexpr std::uint32_t kLimitDim = 8;

// The work of one launch. Every block is whole: 2^log2_block divides n, log2_block >= 4.
struct LimitWork {
  const void* table = nullptr;       // as uploaded: 32-bit words for fp32, 64-bit words for fp64
  std::vector<double> coefficients;  // c_j, kLimitDim of them; rounded to the precision here
  std::uint64_t n = 0;
  std::uint32_t log2_block = 4;
  std::uint32_t replicates = 1;
  bool fp64 = true;
  bool centred = true;  // coordinates (k + 1/2) 2^-m, else k 2^-m
};

// False where the processor or the build has no AVX2; the limits must not be run then.
bool has_avx2();

// Runs the work on all processors, blocks handed out as threads come free. `partials` becomes what
// the kernel stores, [replicate][block][lane]. Returns the seconds from the first thread's start to
// the last one's end.
double run_digital_limit(const LimitWork& work, std::vector<double>& partials);

}  // namespace koksma::bench
