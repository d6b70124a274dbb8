// koksma_bench: speeds in coordinates/s by the device's own clock, kernels beside hand-written
// limits, and memory against N. Rows: ratio/<name> for every limit, speed/<sampler> for every
// sampler of the catalog beside plain Sobol', points_npy, memory_flat.
// --benchmark_filter=REGEX selects.
// planned_vs_general/<scene>/<sampler> compares planned kernels with general ones.
// prepare times point sets that the device builds; counters/<scene>/<sampler> the cells of the
// default study with counters beside those without, counters/default-study all of them.
// launch_overhead/…, launches_together/…, first_row and default_study: what a run costs besides its
// kernels (launch_cost.hpp).
//
// The exit status is 1 when a row fails, a row's `ratio` is below its `required`, its `slower` or
// `overhead` above its `allowed`, or its `growth_mb` not below its `limit_mb`.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>

#include "counters_cost.hpp"
#include "device/prepare.hpp"
#include "error/error.hpp"
#include "general.hpp"
#include "launch_cost.hpp"
#include "ratio_rows.hpp"
#include "speed_table.hpp"
#include "subject.hpp"

namespace koksma::bench {
namespace {

using State = benchmark::State;

constexpr const char* kSobol = "sobol-shift";

// What was required and missed, for the exit status.
std::vector<std::string>& missed() {
  static std::vector<std::string> rows;
  return rows;
}

// Failures become rows with an error instead of ending the program; what is unsupported here is no
// miss.
template <typename Body>
void guarded(State& state, Body&& body) {
  try {
    body();
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    missed().emplace_back(error.what());
  }
}

void count_coordinates(State& state, double coordinates_per_iteration) {
  state.counters["coordinates/s"] =
      benchmark::Counter(coordinates_per_iteration, benchmark::Counter::kIsIterationInvariantRate);
}

double coordinates(const Plan& plan, std::uint64_t n) {
  return static_cast<double>(n) * plan.cell.replicates * plan.cell.scene.dim;
}

// Resident bytes of this process (second field of statm, in pages).
double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 0x1p-20;
}

// How far resident memory rises above its level after N = 2^20 while N = 2^34 runs, looked at after
// every launch.
void memory_flat(State& state, double limit_mb) {
  guarded(state, [&] {
    constexpr std::uint64_t small = std::uint64_t{1} << 20, large = std::uint64_t{1} << 34;
    Subject subject({"linear-prod:d=2", kSobol, Precision::fp64, large, 1});
    subject.run(small);
    const double before = resident_mb();
    double most = before;
    subject.after_launch([&] { most = std::max(most, resident_mb()); });
    for (auto _ : state) state.SetIterationTime(subject.run(large));
    // The true mean is 1; a wrong index beyond 2^32 would show.
    if (std::abs(subject.mean() - 1) > 1e-8)
      throw std::runtime_error(fmt::format("the mean is {:.17g}, not 1", subject.mean()));
    count_coordinates(state, coordinates(subject.plan(), large));
    state.counters["growth_mb"] = most - before;
    state.counters["limit_mb"] = limit_mb;
    if (most - before >= limit_mb)
      missed().push_back(fmt::format("memory_flat: {:.1f} MiB >= {} MiB", most - before, limit_mb));
  });
}

// The verb `points` as a user runs it, from start to end: a million points in 8 dimensions as .npy.
// The least of five runs must stay below limit_s.
void points_npy(State& state, const std::string& sampler, double limit_s) {
  guarded(state, [&] {
    const std::string out = fmt::format("{}/koksma-bench-{}.npy",
                                        std::filesystem::temp_directory_path().string(), getpid());
    const std::string command = fmt::format(
        KOKSMA_COMMAND " points --sampler {} --dim 8 --n 1000000 --out {}", sampler, out);
    double best = INFINITY;
    for (auto _ : state) {
      for (int run = 0; run < 5; ++run) {
        const auto start = std::chrono::steady_clock::now();
        if (std::system(command.c_str()) != 0) throw std::runtime_error(command + " failed");
        best = std::min(
            best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
      state.SetIterationTime(best);
    }
    std::filesystem::remove(out);
    state.counters["seconds"] = best;
    state.counters["limit_s"] = limit_s;
    if (best >= limit_s)
      missed().push_back(fmt::format("points_npy {}: {:.2f} s >= {} s", sampler, best, limit_s));
  });
}

// Preparing a point set on the device, as a first run does: nothing cached, the program's build
// included; then the same again from the disk. The least of three must stay below limit_s.
void prepare_set(State& state, const std::string& sampler, std::uint64_t n, double limit_s) {
  guarded(state, [&] {
    const std::string folder = fmt::format(
        "{}/koksma-bench-{}", std::filesystem::temp_directory_path().string(), getpid());
    const char* earlier = std::getenv("XDG_CACHE_HOME");
    const std::string before = earlier == nullptr ? "" : earlier;
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    double built = INFINITY, read = INFINITY;
    const auto seconds = [&] {
      Device fresh = Device::choose("");
      const Plan plan =
          make_points_plan(catalog(), sampler, 2, Precision::fp64, n, 1, 1, fresh.facts());
      const auto start = std::chrono::steady_clock::now();
      point_table(fresh, plan);
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    for (auto _ : state) {
      for (int run = 0; run < 3; ++run) {
        std::filesystem::remove_all(folder);
        built = std::min(built, seconds());
        read = std::min(read, seconds());
      }
      state.SetIterationTime(built);
    }
    std::filesystem::remove_all(folder);
    before.empty() ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", before.c_str(), 1);
    state.counters["seconds"] = built;
    state.counters["limit_s"] = limit_s;
    state.counters["cached_s"] = read;
    if (built >= limit_s)
      missed().push_back(fmt::format("prepare {}: {:.2f} s >= {} s", sampler, built, limit_s));
  });
}

void register_rows() {
  const auto timed = [](benchmark::internal::Benchmark* row) {
    return row->UseManualTime()->Unit(benchmark::kMillisecond);
  };
  timed(benchmark::RegisterBenchmark("memory_flat/fp64/d:2", memory_flat, 8.0))->Iterations(1);
  for (const char* sampler : {"sobol", "sobol-owen", "random"})
    timed(benchmark::RegisterBenchmark(fmt::format("points_npy/{}/fp64/d:8", sampler).c_str(),
                                       points_npy, std::string(sampler), 1.0))
        ->Iterations(1);
  for (const char* sampler : {"best-candidate", "poisson-parallel"})
    timed(benchmark::RegisterBenchmark(fmt::format("prepare/{}/n:4096", sampler).c_str(),
                                       prepare_set, std::string(sampler), std::uint64_t{4096},
                                       10.0))
        ->Iterations(1);
  register_ratio_rows(missed());
  register_counters_cost(missed());
  register_launch_cost(missed());
  register_planned_vs_general(missed());
  register_speed_table(missed());
}

}  // namespace
}  // namespace koksma::bench

int main(int argc, char** argv) {
  std::string command = "koksma_bench";
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
  // On a busy machine PoCL's threads, left alone, can share one processor for seconds.
  setenv("POCL_AFFINITY", "1", 0);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const koksma::DeviceFacts facts = koksma::Device::choose("").facts();
  benchmark::AddCustomContext("command", command);
  benchmark::AddCustomContext("device", facts.name + ", " + facts.platform + " " + facts.driver);
  koksma::bench::register_rows();
  benchmark::RunSpecifiedBenchmarks();
  for (const std::string& row : koksma::bench::missed())
    std::fprintf(stderr, "missed: %s\n", row.c_str());
  return koksma::bench::missed().empty() ? 0 : 1;
}
