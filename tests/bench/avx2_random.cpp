// Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011; Random123) in AVX2: the words of the even and of
// the odd lanes stay in the low halves of 64-bit slots through all rounds, where vpmuludq takes and
// leaves them: a round is two products, two shifts and four XORs, and what stands in the high
// halves never counts. The rounds before the words of all lanes differ are done once.
#include "avx2_lanes.hpp"

namespace koksma::bench {
namespace {

constexpr std::uint32_t kPhiloxDim = 8, kRounds = 10;

struct RandomPoints {
  struct State {
    std::uint64_t index;  // of the first of these lanes
    std::uint32_t replicate;
  };
  struct Quartet {
    __m256i word[4];
  };

  __m256 origin;
  __m256i key0[kRounds], key1[kRounds];
  std::uint32_t first_key0, first_key1;

  explicit RandomPoints(const LimitWork& work)
      : origin(_mm256_set1_ps(work.centred ? Fp32::kCentre : 1)),
        first_key0(static_cast<std::uint32_t>(work.seed)),
        first_key1(static_cast<std::uint32_t>(work.seed >> 32)) {
    for (std::uint32_t r = 0; r < kRounds; ++r) {
      key0[r] = _mm256_set1_epi64x(first_key0 + r * 0x9E3779B9U);
      key1[r] = _mm256_set1_epi64x(first_key1 + r * 0xBB67AE85U);
    }
  }

  static State seek(std::uint64_t first, std::uint32_t replicate, std::uint32_t lane) {
    return {first + lane, replicate};
  }
  static void step(State& state, std::uint32_t) { state.index += kLanes; }

  static __m256i broadcast(std::uint32_t word) { return _mm256_set1_epi64x(word); }

  // c0: the low halves of four indices; the others are the same in all lanes.
  Quartet rounds(__m256i c0, std::uint32_t c1, std::uint32_t c2, std::uint32_t c3) const {
    constexpr std::uint32_t kFactor0 = 0xD2511F53U, kFactor1 = 0xCD9E8D57U;
    const __m256i factor0 = broadcast(kFactor0), factor1 = broadcast(kFactor1);
    // Round 0 makes c2 differ between lanes too, round 1 the rest.
    const std::uint64_t shared1 = std::uint64_t{c2} * kFactor1;
    const std::uint32_t shared0 = static_cast<std::uint32_t>(shared1 >> 32) ^ c1 ^ first_key0;
    const std::uint64_t product = std::uint64_t{shared0} * kFactor0;
    __m256i product0 = _mm256_mul_epu32(c0, factor0);
    __m256i w2 = _mm256_xor_si256(_mm256_srli_epi64(product0, 32), broadcast(c3 ^ first_key1));
    __m256i product1 = _mm256_mul_epu32(w2, factor1);
    __m256i w0 = _mm256_xor_si256(
        _mm256_srli_epi64(product1, 32),
        broadcast(static_cast<std::uint32_t>(shared1) ^ (first_key0 + 0x9E3779B9U)));
    __m256i w1 = product1;
    w2 = _mm256_xor_si256(_mm256_xor_si256(product0, key1[1]),
                          broadcast(static_cast<std::uint32_t>(product >> 32)));
    __m256i w3 = broadcast(static_cast<std::uint32_t>(product));
    for (std::uint32_t r = 2; r < kRounds; ++r) {
      product0 = _mm256_mul_epu32(w0, factor0);
      product1 = _mm256_mul_epu32(w2, factor1);
      w0 = _mm256_xor_si256(_mm256_xor_si256(_mm256_srli_epi64(product1, 32), w1), key0[r]);
      w2 = _mm256_xor_si256(_mm256_xor_si256(_mm256_srli_epi64(product0, 32), w3), key1[r]);
      w1 = product1;
      w3 = product0;
    }
    return {{w0, w1, w2, w3}};
  }

  Coordinates<Fp32, kPhiloxDim> draw(const State& state) const {
    const auto low = static_cast<std::uint32_t>(state.index),
               high = static_cast<std::uint32_t>(state.index >> 32);
    const __m256i even = _mm256_add_epi64(broadcast(low), _mm256_setr_epi64x(0, 2, 4, 6));
    const __m256i odd = _mm256_add_epi64(even, broadcast(1));
    const __m256i one = _mm256_set1_epi32(0x3F800000);
    Coordinates<Fp32, kPhiloxDim> x;
    for (std::uint32_t k = 0; k < kPhiloxDim / 4; ++k) {
      const Quartet evens = rounds(even, high, state.replicate, 2 * k);
      const Quartet odds = rounds(odd, high, state.replicate, 2 * k);
      for (std::uint32_t i = 0; i < 4; ++i) {
        const __m256i all =
            _mm256_blend_epi32(evens.word[i], _mm256_slli_epi64(odds.word[i], 32), 0xAA);
        x.at[4 * k + i] = _mm256_sub_ps(
            _mm256_castsi256_ps(_mm256_or_si256(_mm256_srli_epi32(all, 9), one)), origin);
      }
    }
    return x;
  }
};

}  // namespace

double run_random_limit(const LimitWork& work, std::vector<double>& partials) {
  require_written(work.dim == kPhiloxDim && !work.fp64);
  return run_limit<Fp32, RandomPoints, Product<Fp32, kPhiloxDim>>(work, partials);
}

}  // namespace koksma::bench
