// Digital nets in AVX2: states are the bits of floats in [1,2), as in kernels/points/digital.cl.
#pragma once

#include "avx2_lanes.hpp"

namespace koksma::bench {

template <typename P, std::uint32_t kDim>
struct DigitalPoints {
  using Word = typename P::Word;
  struct State {
    typename P::Bits at[kDim];
    const Word* steps;
  };

  const Word* table;
  typename P::Real origin;  // 1, or the float before it

  explicit DigitalPoints(const LimitWork& work)
      : table(static_cast<const Word*>(work.table)),
        origin(P::broadcast(work.centred ? P::kCentre : 1)) {}

  const Word* section(std::uint32_t slot, std::uint32_t replicate) const {
    return table + table[slot] + replicate * table[0];
  }

  // All lanes of a dimension move by the same word.
  static void flip(State& state, const Word* words) {
    for (std::uint32_t d = 0; d < kDim; ++d)
      state.at[d] = _mm256_xor_si256(state.at[d], P::broadcast_word(words[d]));
  }

  State seek(std::uint64_t first, std::uint32_t replicate, std::uint32_t lane) const {
    State state;
    state.steps = section(3, replicate);
    const Word* lanes = section(4, replicate) + lane;
    for (std::uint32_t d = 0; d < kDim; ++d)
      state.at[d] = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(lanes + d * kLanes));
    flip(state, table + table[5] + replicate * table[1]);
    const std::uint64_t gray = first ^ first >> 1;
    for (std::uint32_t k = 4; gray >> k != 0; ++k)
      if ((gray >> k & 1) != 0) flip(state, state.steps + static_cast<std::size_t>(k - 4) * kDim);
    return state;
  }

  static void step(State& state, std::uint32_t j) {
    flip(state, state.steps + static_cast<std::size_t>(__builtin_ctz(j)) * kDim);
  }

  Coordinates<P, kDim> draw(const State& state) const {
    Coordinates<P, kDim> x;
    for (std::uint32_t d = 0; d < kDim; ++d) x.at[d] = P::subtract(P::as_real(state.at[d]), origin);
    return x;
  }
};

}  // namespace koksma::bench
