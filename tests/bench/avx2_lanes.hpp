// What the hand-written limits have in common: registers of coordinates in each precision, the loop
// over the samples of a block, the product integrand. Only for the files that are built with AVX2.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "avx2_limits.hpp"
#include "crew.hpp"

namespace koksma::bench {

inline constexpr std::uint32_t kLanes = 16;

// One register of coordinates in each precision. A pass over a block takes one register of lanes,
// so that eight states fit the sixteen registers of AVX2; two or four side by side were no faster
// on a processor with thirty-two.
struct Fp32 {
  using Word = std::uint32_t;
  using Scalar = float;
  using Real = __m256;
  using Bits = __m256i;
  static constexpr std::uint32_t kWidth = 8;
  struct Sum {
    __m256d low = _mm256_setzero_pd(), high = _mm256_setzero_pd();
  };

  static Real broadcast(Scalar x) { return _mm256_set1_ps(x); }
  static Bits broadcast_word(Word x) { return _mm256_set1_epi32(static_cast<int>(x)); }
  static Real as_real(Bits x) { return _mm256_castsi256_ps(x); }
  static Real subtract(Real a, Real b) { return _mm256_sub_ps(a, b); }
  static Real multiply(Real a, Real b) { return _mm256_mul_ps(a, b); }
  static Real multiply_add(Real a, Real b, Real c) { return _mm256_fmadd_ps(a, b, c); }
  static void add(Sum& sum, Real y) {
    sum.low = _mm256_add_pd(sum.low, _mm256_cvtps_pd(_mm256_castps256_ps128(y)));
    sum.high = _mm256_add_pd(sum.high, _mm256_cvtps_pd(_mm256_extractf128_ps(y, 1)));
  }
  static void store(const Sum& sum, double* out) {
    _mm256_storeu_pd(out, sum.low);
    _mm256_storeu_pd(out + 4, sum.high);
  }
  static constexpr Scalar kCentre = 0x1.fffffep-1F;  // 1 - 2^-24
};

struct Fp64 {
  using Word = std::uint64_t;
  using Scalar = double;
  using Real = __m256d;
  using Bits = __m256i;
  static constexpr std::uint32_t kWidth = 4;
  struct Sum {
    __m256d total = _mm256_setzero_pd();
  };

  static Real broadcast(Scalar x) { return _mm256_set1_pd(x); }
  static Bits broadcast_word(Word x) { return _mm256_set1_epi64x(static_cast<long long>(x)); }
  static Real as_real(Bits x) { return _mm256_castsi256_pd(x); }
  static Real subtract(Real a, Real b) { return _mm256_sub_pd(a, b); }
  static Real multiply(Real a, Real b) { return _mm256_mul_pd(a, b); }
  static Real multiply_add(Real a, Real b, Real c) { return _mm256_fmadd_pd(a, b, c); }
  static void add(Sum& sum, Real y) { sum.total = _mm256_add_pd(sum.total, y); }
  static void store(const Sum& sum, double* out) { _mm256_storeu_pd(out, sum.total); }
  static constexpr Scalar kCentre = 0x1.fffffffffffffp-1;  // 1 - 2^-53
};

// The coordinates of one register of samples. A plain array: GCC drops the alignment of vectors in
// std::array.
template <typename P, std::uint32_t kDim>
struct Coordinates {
  typename P::Real at[kDim];
};

// Where a block lies: its first index and index / 16 at its end, of which the low half is enough to
// count trailing zeros by.
struct BlockRange {
  std::uint64_t first;
  std::uint32_t j, end;
};

inline BlockRange range_of(const LimitWork& work, std::uint64_t block) {
  const std::uint64_t first = block << work.log2_block;
  return {first, static_cast<std::uint32_t>(first >> 4),
          static_cast<std::uint32_t>((block + 1) << (work.log2_block - 4))};
}

// Sums f over the samples of one block of one replicate, a register of lanes at a time. Points has
// State, seek(first, replicate, lane), step(state, new index / 16); f(points, state) is the value.
template <typename P, typename Points, typename F>
void sum_block(const LimitWork& work, const Points& points, const F& f, std::uint64_t block,
               std::uint32_t replicate, double* out) {
  const BlockRange range = range_of(work, block);
  for (std::uint32_t lane = 0; lane < kLanes; lane += P::kWidth) {
    typename Points::State state = points.seek(range.first, replicate, lane);
    typename P::Sum sum;
    for (std::uint32_t j = range.j;;) {
      P::add(sum, f(points, state));
      if (++j == range.end) break;
      points.step(state, j);
    }
    P::store(sum, out + lane);
  }
}

// prod_j (1 + c_j (x_j - 1/2)).
template <typename P, std::uint32_t kDim>
struct Product {
  typename P::Real c[kDim];

  explicit Product(const LimitWork& work) {
    for (std::uint32_t d = 0; d < kDim; ++d)
      c[d] = P::broadcast(static_cast<typename P::Scalar>(work.coefficients[d]));
  }
  template <typename Points>
  typename P::Real operator()(const Points& points, const typename Points::State& state) const {
    const typename P::Real one = P::broadcast(1), half = P::broadcast(0.5F);
    const Coordinates<P, kDim> x = points.draw(state);
    typename P::Real product = one;
    for (std::uint32_t d = 0; d < kDim; ++d) {
      const typename P::Real factor = P::multiply_add(P::subtract(x.at[d], half), c[d], one);
      product = d == 0 ? factor : P::multiply(product, factor);
    }
    return product;
  }
};

// block(index, replicate, out) for every block of every replicate, on all processors.
template <typename Block>
double run_blocks(const LimitWork& work, std::vector<double>& partials, const Block& block) {
  const std::uint64_t blocks = work.n >> work.log2_block, units = blocks * work.replicates;
  partials.resize(units * kLanes);
  return run_on_crew(units, [&](std::uint64_t unit) {
    block(unit % blocks, static_cast<std::uint32_t>(unit / blocks), &partials[unit * kLanes]);
  });
}

template <typename P, typename Points, typename F>
double run_limit(const LimitWork& work, std::vector<double>& partials) {
  const Points points(work);
  const F f(work);
  return run_blocks(work, partials, [&](std::uint64_t block, std::uint32_t replicate, double* out) {
    sum_block<P>(work, points, f, block, replicate, out);
  });
}

inline void require_written(bool written) {
  if (!written)
    throw std::invalid_argument("the limit is not written for that dimension or precision");
}

}  // namespace koksma::bench
