#include "avx2_limit.hpp"

#ifdef __AVX2__
#include <immintrin.h>
#include <sched.h>

#include <atomic>
#include <barrier>
#include <chrono>
#include <functional>
#include <thread>
#endif

namespace koksma::bench {
#ifdef __AVX2__
namespace {

constexpr std::uint32_t kLanes = 16;

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

template <typename P>
struct Digital {
  using Word = typename P::Word;
  using Real = typename P::Real;
  using Bits = typename P::Bits;
  // Bits of floats in [1,2). Plain arrays: GCC drops the alignment of vectors in std::array.
  struct States {
    Bits at[kLimitDim];
  };

  const Word* table;
  Real c[kLimitDim];
  Real origin;  // 1, or the float before it

  explicit Digital(const LimitWork& work)
      : table(static_cast<const Word*>(work.table)),
        origin(P::broadcast(work.centred ? P::kCentre : 1)) {
    for (std::uint32_t d = 0; d < kLimitDim; ++d)
      c[d] = P::broadcast(static_cast<typename P::Scalar>(work.coefficients[d]));
  }

  const Word* section(std::uint32_t slot, std::uint32_t replicate) const {
    return table + table[slot] + replicate * table[0];
  }

  // All lanes of a dimension move by the same word.
  static void flip(States& states, const Word* words) {
    for (std::uint32_t d = 0; d < kLimitDim; ++d)
      states.at[d] = _mm256_xor_si256(states.at[d], P::broadcast_word(words[d]));
  }

  States seek(std::uint64_t first, std::uint32_t replicate, std::uint32_t lane) const {
    States states;
    const Word* lanes = section(4, replicate) + lane;
    for (std::uint32_t d = 0; d < kLimitDim; ++d)
      states.at[d] = _mm256_loadu_si256(reinterpret_cast<const Bits*>(lanes + d * kLanes));
    flip(states, table + table[5] + replicate * table[1]);
    const std::uint64_t gray = first ^ first >> 1;
    for (std::uint32_t k = 4; gray >> k != 0; ++k)
      if ((gray >> k & 1) != 0)
        flip(states, section(3, replicate) + static_cast<std::size_t>(k - 4) * kLimitDim);
    return states;
  }

  Real integrand(const States& states) const {
    const Real one = P::broadcast(1), half = P::broadcast(0.5F);
    Real product = one;
    for (std::uint32_t d = 0; d < kLimitDim; ++d) {
      const Real x = P::subtract(P::as_real(states.at[d]), origin);
      const Real factor = P::multiply_add(P::subtract(x, half), c[d], one);
      product = d == 0 ? factor : P::multiply(product, factor);
    }
    return product;
  }

  // One block of one replicate, kWidth lanes at a time.
  void run_block(const LimitWork& work, std::uint64_t block, std::uint32_t replicate,
                 double* out) const {
    const std::uint64_t first = block << work.log2_block;
    // Index / 16 at the end of the block; its low half is enough to count trailing zeros by.
    const auto end = static_cast<std::uint32_t>((block + 1) << (work.log2_block - 4));
    const Word* steps = section(3, replicate);
    for (std::uint32_t lane = 0; lane < kLanes; lane += P::kWidth) {
      States states = seek(first, replicate, lane);
      typename P::Sum sum;
      for (auto j = static_cast<std::uint32_t>(first >> 4);;) {
        P::add(sum, integrand(states));
        if (++j == end) break;
        flip(states, steps + static_cast<std::size_t>(__builtin_ctz(j)) * kLimitDim);
      }
      P::store(sum, out + lane);
    }
  }
};

// One thread on each processor for the life of the program, as an OpenCL implementation keeps them.
// Pinned: on a busy machine threads left alone can share one processor for seconds.
class Crew {
 public:
  Crew()
      : processors_(allowed_processors()),
        gate_(static_cast<std::ptrdiff_t>(processors_.size()) + 1) {
    for (const int processor : processors_)
      threads_.emplace_back([this, processor] { serve(processor); });
  }
  ~Crew() {
    stop_ = true;
    gate_.arrive_and_wait();
    for (std::thread& thread : threads_) thread.join();
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  // Runs `work` once on every thread.
  void run(const std::function<void()>& work) {
    work_ = &work;
    gate_.arrive_and_wait();
    gate_.arrive_and_wait();
  }

 private:
  static std::vector<int> allowed_processors() {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    std::vector<int> processors;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
      for (int i = 0; i < CPU_SETSIZE; ++i)
        if (CPU_ISSET(i, &allowed)) processors.push_back(i);
    return processors;
  }
  void serve(int processor) {
    cpu_set_t own;
    CPU_ZERO(&own);
    CPU_SET(processor, &own);
    sched_setaffinity(0, sizeof own, &own);
    while (true) {
      gate_.arrive_and_wait();
      if (stop_) return;
      (*work_)();
      gate_.arrive_and_wait();
    }
  }

  std::vector<int> processors_;
  std::barrier<> gate_;  // passed at the start and at the end of every run
  const std::function<void()>* work_ = nullptr;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

Crew& crew() {
  static Crew every_processor;
  return every_processor;
}

template <typename P>
double run_digital(const LimitWork& work, std::vector<double>& partials) {
  const std::uint64_t blocks = work.n >> work.log2_block, units = blocks * work.replicates;
  partials.resize(units * kLanes);
  const Digital<P> digital(work);
  std::atomic<std::uint64_t> next{0};
  const auto start = std::chrono::steady_clock::now();
  crew().run([&] {
    for (std::uint64_t unit = next++; unit < units; unit = next++)
      digital.run_block(work, unit % blocks, static_cast<std::uint32_t>(unit / blocks),
                        &partials[unit * kLanes]);
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}

double run_digital_limit(const LimitWork& work, std::vector<double>& partials) {
  return work.fp64 ? run_digital<Fp64>(work, partials) : run_digital<Fp32>(work, partials);
}
#else
bool has_avx2() { return false; }

double run_digital_limit(const LimitWork&, std::vector<double>&) { return 0; }
#endif

}  // namespace koksma::bench
