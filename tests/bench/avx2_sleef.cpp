// Loops on SLEEF's vector functions (N. Shibata and F. Petrogalli, IEEE Trans. Parallel Distrib.
// Syst. 31 (2020)). A call may spoil all vector registers, so arguments are gathered first and the
// function runs over many of them at once.
#include <sleef.h>

#include "avx2_digital.hpp"

namespace koksma::bench {
namespace {

constexpr std::uint32_t kSleefDim = 8;
using Points = DigitalPoints<Fp32, kSleefDim>;

// exp-sum: factor exp(sum c_j (x_j - 1/2)).
struct ExpSum {
  __m256 c[kSleefDim], factor;

  explicit ExpSum(const LimitWork& work)
      : factor(_mm256_set1_ps(static_cast<float>(work.coefficients[1]))) {
    for (std::size_t d = 0; d < kSleefDim; ++d)
      c[d] = _mm256_set1_ps(static_cast<float>(work.coefficients[2 * d]));
  }
  __m256 argument(const Coordinates<Fp32, kSleefDim>& x) const {
    __m256 sum = _mm256_setzero_ps();
    for (std::uint32_t d = 0; d < kSleefDim; ++d)
      sum = _mm256_fmadd_ps(c[d], _mm256_sub_ps(x.at[d], _mm256_set1_ps(0.5F)), sum);
    return sum;
  }
  __m256 value(__m256 argument) const {
    return _mm256_mul_ps(factor, Sleef_expf8_u10avx2(argument));
  }
};

// genz-oscillatory: cos(2 pi w + sum a_j x_j); kUnit: the angle's unit, in radians.
template <auto kCosine>
struct Oscillatory {
  __m256 c[kSleefDim], phase;

  Oscillatory(const LimitWork& work, double unit)
      : phase(_mm256_set1_ps(static_cast<float>(2 * work.parameters[1] * unit))) {
    for (std::uint32_t d = 0; d < kSleefDim; ++d)
      c[d] = _mm256_set1_ps(static_cast<float>(work.coefficients[d] * unit));
  }
  __m256 argument(const Coordinates<Fp32, kSleefDim>& x) const {
    __m256 sum = phase;
    for (std::uint32_t d = 0; d < kSleefDim; ++d) sum = _mm256_fmadd_ps(c[d], x.at[d], sum);
    return sum;
  }
  __m256 value(__m256 argument) const { return kCosine(argument); }
};

template <typename F>
double run_function(const LimitWork& work, std::vector<double>& partials, const F& f) {
  require_written(work.dim == kSleefDim && !work.fp64);
  const Points points(work);
  return run_blocks(work, partials, [&](std::uint64_t block, std::uint32_t replicate, double* out) {
    constexpr std::uint32_t kMany = 64;
    __m256 arguments[kMany];
    const BlockRange range = range_of(work, block);
    for (std::uint32_t lane = 0; lane < kLanes; lane += Fp32::kWidth) {
      Points::State state = points.seek(range.first, replicate, lane);
      Fp32::Sum sum;
      for (std::uint32_t j = range.j; j != range.end;) {
        std::uint32_t count = 0;
        while (count < kMany && j != range.end) {
          arguments[count++] = f.argument(points.draw(state));
          if (++j != range.end) Points::step(state, j);
        }
        for (std::uint32_t k = 0; k < count; ++k) Fp32::add(sum, f.value(arguments[k]));
      }
      Fp32::store(sum, out + lane);
    }
  });
}

constexpr double kPi = 3.14159265358979323846;

}  // namespace

double run_exp_limit(const LimitWork& work, std::vector<double>& partials) {
  return run_function(work, partials, ExpSum(work));
}

double run_cos_limit(const LimitWork& work, std::vector<double>& partials) {
  return run_function(work, partials, Oscillatory<Sleef_cosf8_u10avx2>(work, kPi));
}

double run_cospi_limit(const LimitWork& work, std::vector<double>& partials) {
  return run_function(work, partials, Oscillatory<Sleef_cospif8_u05avx2>(work, 1));
}

}  // namespace koksma::bench
