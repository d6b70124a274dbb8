#include "avx2_digital.hpp"

namespace koksma::bench {
namespace {

template <typename P, std::uint32_t kDim>
double run_product(const LimitWork& work, std::vector<double>& partials) {
  return run_limit<P, DigitalPoints<P, kDim>, Product<P, kDim>>(work, partials);
}

// Constants in double, rounded once: their rounding is a bias that the kernel does not have.
struct FoldedProduct {
  static constexpr std::uint32_t kDim = 8;
  __m256 c[kDim], offset[kDim];

  explicit FoldedProduct(const LimitWork& work) {
    const double centre = 0.5 + (work.centred ? Fp32::kCentre : 1.0);  // of s in [1,2)
    for (std::uint32_t d = 0; d < kDim; ++d) {
      c[d] = _mm256_set1_ps(static_cast<float>(work.coefficients[d]));
      offset[d] = _mm256_set1_ps(static_cast<float>(1 - work.coefficients[d] * centre));
    }
  }
  __m256 operator()(const DigitalPoints<Fp32, kDim>&,
                    const DigitalPoints<Fp32, kDim>::State& state) const {
    __m256 product = _mm256_fmadd_ps(_mm256_castsi256_ps(state.at[0]), c[0], offset[0]);
    for (std::uint32_t d = 1; d < kDim; ++d)
      product = _mm256_mul_ps(product,
                              _mm256_fmadd_ps(_mm256_castsi256_ps(state.at[d]), c[d], offset[d]));
    return product;
  }
};

}  // namespace

double run_digital_limit(const LimitWork& work, std::vector<double>& partials) {
  if (work.fp64) {
    require_written(work.dim == 8);
    return run_product<Fp64, 8>(work, partials);
  }
  if (work.dim == 128) return run_product<Fp32, 128>(work, partials);
  if (work.dim == 1024) return run_product<Fp32, 1024>(work, partials);
  require_written(work.dim == 8);
  return run_product<Fp32, 8>(work, partials);
}

double run_folded_limit(const LimitWork& work, std::vector<double>& partials) {
  require_written(work.dim == FoldedProduct::kDim && !work.fp64);
  return run_limit<Fp32, DigitalPoints<Fp32, FoldedProduct::kDim>, FoldedProduct>(work, partials);
}

}  // namespace koksma::bench
