#include "ratio_rows.hpp"

#include <fmt/format.h>
#include <time.h>

#include <cmath>
#include <exception>
#include <numeric>
#include <optional>

#include "avx2_limits.hpp"
#include "error/error.hpp"
#include "rounds.hpp"
#include "subject.hpp"

namespace koksma::bench {

namespace {

using State = benchmark::State;

// 2^26 coordinates a launch: 3 to 30 ms, long beside the 60 us that a launch costs, and short
// enough to find all processors free for all of it now and then.
constexpr std::uint64_t kCoordinates = std::uint64_t{1} << 26;
constexpr std::uint32_t kRatioReplicates = 4;
// Kernel and limit alternate at least this often, and until both minima have been met three times,
// as machines jitter.
constexpr std::size_t kLeastRatioRounds = 101, kMostRatioRounds = 400;

#if KOKSMA_LIMITS_AVX2
constexpr Limit kDigital = run_digital_limit, kFolded = run_folded_limit,
                kLattice = run_lattice_limit, kRandom = run_random_limit;
#else
double no_avx2(const LimitWork&, std::vector<double>&) {
  throw UnsupportedError("the hand-written limits need a processor with AVX2");
}
constexpr Limit kDigital = no_avx2, kFolded = no_avx2, kLattice = no_avx2, kRandom = no_avx2;
#endif

#if KOKSMA_LIMITS_SLEEF
constexpr Limit kExp = run_exp_limit, kCos = run_cos_limit, kCospi = run_cospi_limit;
#else
double no_sleef(const LimitWork&, std::vector<double>&) {
  throw UnsupportedError("the limits of exp and cos need SLEEF (libsleef-dev) when this is built");
}
constexpr Limit kExp = no_sleef, kCos = no_sleef, kCospi = no_sleef;
#endif

struct RatioRow {
  const char *name, *scene, *sampler;
  Precision precision;
  Limit limit;
  double required;
  // How far the means may differ, relative to the limit's: by the rounding of the samples where
  // both do the same operations; else also by that of the limit's constants.
  double tolerance;
  const char* limit_scene = nullptr;  // of another dimension: compared per coordinate
};

// The same product drawn from either slot: as it stands in the catalog, from the centred one.
constexpr const char *kPlain = "plain-prod:d=8", *kProduct = "linear-prod:d=8";
constexpr RatioRow kRows[] = {
    {"sobol/fp32/d:8/same", kPlain, "sobol-shift", Precision::fp32, kDigital, 0.95, 2e-8},
    {"sobol/fp32/d:8/folded", kProduct, "sobol-shift", Precision::fp32, kFolded, 0.8, 5e-7},
    {"sobol/fp32/d:128", "plain-prod:d=128", "sobol-shift", Precision::fp32, kDigital, 0.7, 2e-8,
     kPlain},
    {"sobol/fp32/d:1024", "plain-prod:d=1024", "sobol-shift", Precision::fp32, kDigital, 0.6, 2e-8,
     kPlain},
    {"sobol/fp64/d:8", kPlain, "sobol-shift", Precision::fp64, kDigital, 0.95, 1e-14},
    {"random/fp32/d:8", kPlain, "random", Precision::fp32, kRandom, 0.8, 2e-8},
    {"lattice-shift/fp32/d:8", kPlain, "lattice-shift", Precision::fp32, kLattice, 0.85, 2e-8},
    {"exp/fp32/d:8", "exp-sum:d=8", "sobol-shift", Precision::fp32, kExp, 0.9, 1e-7},
    {"cos/fp32/d:8", "genz-oscillatory:d=8", "sobol-shift", Precision::fp32, kCos, 0.9, 1e-6},
    {"cospi/fp32/d:8", "genz-oscillatory:d=8", "sobol-shift", Precision::fp32, kCospi, 0.9, 1e-6},
};

#if defined(__x86_64__)
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}
bool has_avx512() { return __builtin_cpu_supports("avx512f") != 0; }
#else
bool has_avx2() { return false; }
bool has_avx512() { return false; }
#endif

SubjectSpec spec_of(const RatioRow& row, const char* scene) {
  const std::uint32_t dim = parse_scene(catalog(), scene, "benchmark").dim;
  const Sampler sampler = catalog().sampler(row.sampler, "benchmark");
  const std::uint64_t n = std::min(kCoordinates / kRatioReplicates / dim,
                                   std::uint64_t{1} << std::min(sampler.max_log2_n, 62U));
  return {scene, row.sampler, row.precision, n, kRatioReplicates};
}

// The limits' states are mantissas, whatever form the kernel prefers.
std::vector<std::byte> mantissa_table(Plan plan) {
  plan.request.centred_draws = false;
  return build_point_table(plan);
}

// A kernel and the work of its limit.
struct Pair {
  explicit Pair(const SubjectSpec& spec)
      : n(spec.end), subject(spec), table(mantissa_table(subject.plan())) {
    const Plan& plan = subject.plan();
    work = {table.data(),
            subject.coefficients(),
            plan.cell.scene.parameters,
            n,
            subject.log2_block(n),
            plan.launched_replicates(),
            plan.cell.scene.dim,
            plan.cell.seed,
            plan.fp64(),
            plan.sampler->centred};
  }
  double coordinates() const { return static_cast<double>(n) * work.replicates * work.dim; }

  std::uint64_t n;
  Subject subject;
  std::vector<std::byte> table;
  LimitWork work;
};

// The same points and, up to rounding, the same values.
void require_same_mean(Pair& pair, const RatioRow& row) {
  std::vector<double> partials;
  pair.subject.run(pair.n);
  row.limit(pair.work, partials);
  const double mean = std::accumulate(partials.begin(), partials.end(), 0.0) /
                      (static_cast<double>(pair.n) * pair.work.replicates);
  if (std::abs(pair.subject.mean() - mean) <= row.tolerance * std::abs(mean)) return;
  throw std::runtime_error(fmt::format("{}: the kernel's mean {:.17g} is not the limit's {:.17g}",
                                       row.name, pair.subject.mean(), mean));
}

// The processors' time of this process, which others on a busy machine disturb least.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The fastest round of one side, and the processors' time of all its rounds: the clock charges a
// thread by ticks, so single rounds tell little.
struct Times {
  Fastest wall;
  double processors = 0;
  template <typename Run>
  void add(const Run& run) {
    const double before = processor_seconds();
    wall.add(run());
    processors += processor_seconds() - before;
  }
};

// One iteration holds all rounds; its time is the kernel's best.
void measure(State& state, const RatioRow& row, std::vector<std::string>& missed) {
  if (!has_avx2()) throw UnsupportedError("the hand-written limits need a processor with AVX2");
  Pair pair(spec_of(row, row.scene));
  require_same_mean(pair, row);
  std::optional<Pair> other;
  if (row.limit_scene != nullptr) other.emplace(spec_of(row, row.limit_scene));
  const Pair& limit = other ? *other : pair;
  std::vector<double> partials;
  Times kernel_s, limit_s;
  std::size_t rounds = 0;
  for (auto _ : state) {
    while (rounds < kLeastRatioRounds ||
           (rounds < kMostRatioRounds && !(kernel_s.wall.settled() && limit_s.wall.settled()))) {
      kernel_s.add([&] { return pair.subject.run(pair.n); });
      limit_s.add([&] { return row.limit(limit.work, partials); });
      ++rounds;
    }
    state.SetIterationTime(kernel_s.wall.best());
  }
  const double kernel_speed = pair.coordinates() / kernel_s.wall.best(),
               limit_speed = limit.coordinates() / limit_s.wall.best(),
               ratio = kernel_speed / limit_speed;
  state.counters["ratio"] = ratio;
  state.counters["required"] = row.required;
  state.counters["processor_ratio"] =
      pair.coordinates() / kernel_s.processors / (limit.coordinates() / limit_s.processors);
  state.counters["kernel/s"] = kernel_speed;
  state.counters["limit/s"] = limit_speed;
  state.counters["rounds"] = static_cast<double>(rounds);
  state.counters["avx512"] = has_avx512() ? 1 : 0;
  if (ratio < row.required)
    missed.push_back(fmt::format("{}: ratio {:.3f} < {}", row.name, ratio, row.required));
}

// What is unsupported here is no miss; any other failure is one.
void guarded(State& state, const RatioRow& row, std::vector<std::string>& missed) {
  try {
    measure(state, row, missed);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    missed.emplace_back(error.what());
  }
}

}  // namespace

void register_ratio_rows(std::vector<std::string>& missed) {
  for (const RatioRow& row : kRows)
    benchmark::RegisterBenchmark(fmt::format("ratio/{}", row.name).c_str(),
                                 [&row, &missed](State& state) { guarded(state, row, missed); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
}

}  // namespace koksma::bench
