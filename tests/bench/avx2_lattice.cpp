// Embedded rank-1 lattices, states as in kernels/points/lattice.cl for few dimensions: one load and
// one addition step a register, and a coordinate is its conversion.
#include "avx2_lanes.hpp"

namespace koksma::bench {
namespace {

constexpr std::uint32_t kDim = 8;

struct LatticePoints {
  struct State {
    __m256i at[kDim];
    const std::uint32_t* steps;
  };

  const std::uint32_t* table;
  __m256 centre;  // 1/2, or half a unit more

  explicit LatticePoints(const LimitWork& work)
      : table(static_cast<const std::uint32_t*>(work.table)),
        centre(_mm256_set1_ps(work.centred ? 0x1.000002p-1F : 0.5F)) {}

  static __m256i load(const std::uint32_t* words) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(words));
  }

  State seek(std::uint64_t first, std::uint32_t replicate, std::uint32_t lane) const {
    const std::size_t vector = std::size_t{replicate} * table[5], odd = first >> 4 & 1;
    const std::uint32_t* columns = table + table[1] + vector;
    const std::uint32_t* lanes = table + table[3] + vector + lane + odd * kDim * kLanes;
    const std::uint32_t* starts = table + table[4] + std::size_t{replicate} * table[0];
    State state;
    state.steps = table + table[2] + vector + lane;
    const std::uint64_t gray = first ^ first >> 1;
    for (std::size_t d = 0; d < kDim; ++d) {
      std::uint32_t shared = starts[d];
      for (std::uint32_t k = 4; gray >> k != 0; ++k)
        if ((gray >> k & 1) != 0) shared += columns[std::size_t{k - 4} * kDim + d];
      state.at[d] =
          _mm256_add_epi32(load(lanes + d * kLanes), _mm256_set1_epi32(static_cast<int>(shared)));
    }
    return state;
  }

  static void step(State& state, std::uint32_t j) {
    const auto c = static_cast<std::uint32_t>(__builtin_ctz(j));
    const std::uint32_t comes = 1 - (j >> c >> 1 & 1);
    const std::uint32_t* words = state.steps + std::size_t{c * 2 + comes} * kDim * kLanes;
    for (std::size_t d = 0; d < kDim; ++d)
      state.at[d] = _mm256_add_epi32(state.at[d], load(words + d * kLanes));
  }

  Coordinates<Fp32, kDim> draw(const State& state) const {
    const __m256 scale = _mm256_set1_ps(0x1p-32F);
    Coordinates<Fp32, kDim> x;
    for (std::size_t d = 0; d < kDim; ++d)
      x.at[d] = _mm256_fmadd_ps(_mm256_cvtepi32_ps(state.at[d]), scale, centre);
    return x;
  }
};

}  // namespace

double run_lattice_limit(const LimitWork& work, std::vector<double>& partials) {
  require_written(work.dim == kDim && !work.fp64);
  return run_limit<Fp32, LatticePoints, Product<Fp32, kDim>>(work, partials);
}

}  // namespace koksma::bench
