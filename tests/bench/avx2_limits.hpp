// Hand-written AVX2 limits: what a person would write for exactly the work of one fused kernel, to
// measure the kernel against. Same points from the same table, same blocks, lanes and order of
// additions, sums in fp64. Method: 3-kernels, points 2, 3 and 6; the tables' layouts are at the
// heads of kernels/points/digital.cl and lattice.cl, the random stream is in kernels/README.md.
// Where the build has no AVX2 (or no SLEEF, for those that need it) the limits throw
// UnsupportedError.
#pragma once

#include <cstdint>
#include <vector>

namespace koksma::bench {

// The work of one launch. Every block is whole: 2^log2_block divides n, log2_block >= 4.
struct LimitWork {
  const void* table = nullptr;       // as uploaded: 32-bit words for fp32, 64-bit words for fp64
  std::vector<double> coefficients;  // of the integrand's set-up; rounded to the precision here
  std::vector<double> parameters;    // of the scene, in the entry's order
  std::uint64_t n = 0;
  std::uint32_t log2_block = 4;
  std::uint32_t replicates = 1;
  std::uint32_t dim = 8;
  std::uint64_t seed = 0;
  bool fp64 = true;
  bool centred = true;  // coordinates (k + 1/2) 2^-m, else k 2^-m
};

// Run the work on all processors, blocks handed out as threads come free. `partials` becomes what
// the kernel stores, [replicate][block][lane]. Return seconds (run_on_crew). std::invalid_argument
// where the limit is not written for that dimension or precision.
using Limit = double (*)(const LimitWork& work, std::vector<double>& partials);

// Digital nets, prod_j (1 + c_j (x_j - 1/2)), operation by operation. fp32 and fp64, d = 8; fp32
// also d = 128 and 1024, to compare means: those states are beyond the registers and not tuned.
double run_digital_limit(const LimitWork& work, std::vector<double>& partials);
// The same in fp32, d = 8, with scale and constants folded by hand: 1 + c (x - 1/2) is one fused
// multiplication and addition of the state's float s in [1,2), s c + (1 - c (x - s + 1/2)).
double run_folded_limit(const LimitWork& work, std::vector<double>& partials);
// Shifted rank-1 lattices and the same product, fp32, d = 8.
double run_lattice_limit(const LimitWork& work, std::vector<double>& partials);
// Philox4x32-10 and the same product, fp32, d = 8.
double run_random_limit(const LimitWork& work, std::vector<double>& partials);
// Digital nets with exp-sum by Sleef_expf8_u10, with genz-oscillatory by Sleef_cosf8_u10 of the
// angle in radians and by Sleef_cospif8_u05; fp32, d = 8.
double run_exp_limit(const LimitWork& work, std::vector<double>& partials);
double run_cos_limit(const LimitWork& work, std::vector<double>& partials);
double run_cospi_limit(const LimitWork& work, std::vector<double>& partials);

}  // namespace koksma::bench
