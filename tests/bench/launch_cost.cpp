#include "launch_cost.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <numeric>

#include "estimate/exact_sum.hpp"
#include "estimate/timed_launches.hpp"
#include "rounds.hpp"
#include "subject.hpp"

namespace koksma::bench {
namespace {

using State = benchmark::State;
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

constexpr double kAllowedOverhead = 0.10;
constexpr double kFirstRowLimit = 0.25;
constexpr double kStudyLimit = 15;
constexpr std::uint32_t kDim = 8, kReplicates = 32;
constexpr std::size_t kLeastLaunchRounds = 300, kMostLaunchRounds = 3000;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Cell cell_of(const std::string& sampler, Precision precision, unsigned log2_coordinates) {
  Cell cell;
  cell.scene = parse_scene(catalog(), fmt::format("linear-prod:d={}", kDim), "benchmark");
  cell.sampler = sampler;
  cell.estimator = catalog().sampler(sampler, "benchmark").default_estimator;
  cell.precision = precision;
  cell.n = {(std::uint64_t{1} << log2_coordinates) / kDim / kReplicates};
  cell.replicates = kReplicates;
  cell.seed = 1;
  return cell;
}

struct OverheadRow {
  std::string sampler;
  Precision precision;
  unsigned log2_coordinates;
};

// Seconds of `runs` runs.
struct LaunchTimes {
  double wall, kernel;
  std::size_t runs;
};

void report_overhead(State& state, const char* name, const OverheadRow& row,
                     const LaunchTimes& times, std::vector<std::string>& missed) {
  const double overhead = times.wall / times.kernel - 1;
  const double us = 1e6 / static_cast<double>(times.runs);
  state.counters["overhead"] = overhead;
  state.counters["allowed"] = kAllowedOverhead;
  state.counters["kernel_us"] = times.kernel * us;
  state.counters["wall_us"] = times.wall * us;
  if (overhead > kAllowedOverhead)
    missed.push_back(fmt::format("{} {} {} 2^{}: {:.3f} > {}", name, precision_name(row.precision),
                                 row.sampler, row.log2_coordinates, overhead, kAllowedOverhead));
}

void launch_overhead(State& state, const OverheadRow& row, std::vector<std::string>& missed) {
  const Plan plan = make_plan(catalog(), cell_of(row.sampler, row.precision, row.log2_coordinates),
                              device().facts());
  Integrator integrator(device(), plan,
                        compute_exact(device(), *plan.integrand, plan.cell.scene).coefficients);
  const std::uint64_t n = plan.cell.n.front();
  Fastest kernel, wall, merged;
  std::vector<ExactSum> sums;
  const auto nothing = [](std::uint32_t, std::uint32_t, std::span<const double>) {};
  const auto merge = [&](std::uint32_t word, std::uint32_t r, std::span<const double> partials) {
    sums[std::size_t{word} * kReplicates + r].add(partials, plan.word_exponent(word));
  };
  std::size_t rounds = 0;
  for (auto _ : state) {
    while (
        rounds < kLeastLaunchRounds ||
        (rounds < kMostLaunchRounds && !(kernel.settled() && wall.settled() && merged.settled()))) {
      auto start = Clock::now();
      kernel.add(integrator.run(n, 0, nothing));
      wall.add(seconds_since(start));
      start = Clock::now();
      sums.assign(std::size_t{plan.words()} * kReplicates, ExactSum{});
      kernel.add(integrator.run(n, 0, merge));
      merged.add(seconds_since(start));
      ++rounds;
    }
    state.SetIterationTime(wall.best());
  }
  state.counters["with_merge"] = merged.best() / kernel.best() - 1;
  state.counters["rounds"] = static_cast<double>(rounds);
  report_overhead(state, "launch_overhead", row, {wall.best(), kernel.best(), 1}, missed);
}

// The same launches as koksma times short rows: several runs each, and so many behind each other
// before one wait, 5 ms of the shortest row, which is what it queues.
constexpr std::size_t kTogether = 24, kLeastTogetherRounds = 60, kMostTogetherRounds = 600;

void overhead_together(State& state, const OverheadRow& row, std::vector<std::string>& missed) {
  const Plan plan = make_plan(catalog(), cell_of(row.sampler, row.precision, row.log2_coordinates),
                              device().facts());
  Integrator integrator(device(), plan,
                        compute_exact(device(), *plan.integrand, plan.cell.scene).coefficients);
  const std::uint64_t n = plan.cell.n.front();
  const auto nothing = [](std::uint32_t, std::uint32_t, std::span<const double>) {};
  const std::uint32_t room = integrator.runs_at_once(n);
  if (room == 0) throw std::runtime_error("a run is more than one launch");
  integrator.run(n, 0, nothing);
  const std::uint32_t runs = runs_of_launch(integrator, n, 0, integrator.run(n, 0, nothing));
  // Of a fourth of the launches, four times the runs: what a launch's start adds to kernel_s.
  const std::vector<RepeatedRun> longer(kTogether / 4, {n, std::min(4 * runs, room)});
  Fastest longer_run;
  const std::vector<RepeatedRun> launches(kTogether, RepeatedRun{n, runs});
  Fastest kernel, wall;
  std::size_t rounds = 0;
  for (auto _ : state) {
    while (rounds < kLeastTogetherRounds ||
           (rounds < kMostTogetherRounds && !(kernel.settled() && wall.settled()))) {
      const auto start = Clock::now();
      const std::vector<double> run_s = integrator.times_together(launches, 0);
      wall.add(seconds_since(start));
      kernel.add(std::accumulate(run_s.begin(), run_s.end(), 0.0) * runs);
      const std::vector<double> longer_s = integrator.times_together(longer, 0);
      longer_run.add(std::accumulate(longer_s.begin(), longer_s.end(), 0.0) /
                     static_cast<double>(longer.size()));
      ++rounds;
    }
    state.SetIterationTime(wall.best());
  }
  state.counters["rounds"] = static_cast<double>(rounds);
  state.counters["runs"] = runs;
  state.counters["longer_runs"] = longer.front().runs;
  state.counters["start"] = kernel.best() / (kTogether * runs) / longer_run.best() - 1;
  report_overhead(state, "launches_together", row, {wall.best(), kernel.best(), kTogether * runs},
                  missed);
}

// A folder for results and, where asked, caches of its own; it goes away with the object.
class Scratch {
 public:
  Scratch()
      : path_(fmt::format("{}/koksma-bench-{}", fs::temp_directory_path().string(), getpid())) {
    fs::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path(const char* name) const { return fmt::format("{}/{}", path_, name); }

 private:
  std::string path_;
};

// Seconds that the command takes from start to end. Caches, PoCL's too, are the scratch folder's.
double run_command(const Scratch& scratch, const std::string& arguments) {
  const std::string line =
      fmt::format("KOKSMA_KEPT=on XDG_CACHE_HOME={} POCL_CACHE_DIR={} " KOKSMA_COMMAND
                  " run {} --quiet --out {} >/dev/null",
                  scratch.path("cache"), scratch.path("pocl"), arguments, scratch.path("out.json"));
  fs::create_directories(scratch.path("pocl"));
  const auto start = Clock::now();
  if (std::system(line.c_str()) != 0) throw std::runtime_error(line + " failed");
  return seconds_since(start);
}

void first_row(State& state, std::vector<std::string>& missed) {
  const Scratch scratch;
  const std::string arguments = "--scene genz-gaussian:d=2 --sampler sobol-owen --n 2^10";
  const double cold = run_command(scratch, arguments);
  Fastest warm;
  for (auto _ : state) {
    for (int run = 0; run < 9; ++run) warm.add(run_command(scratch, arguments));
    state.SetIterationTime(warm.best());
  }
  state.counters["seconds"] = warm.best();
  state.counters["limit_s"] = kFirstRowLimit;
  state.counters["cold_s"] = cold;
  if (warm.best() >= kFirstRowLimit)
    missed.push_back(fmt::format("first_row: {:.3f} s >= {} s", warm.best(), kFirstRowLimit));
}

// Of the results that the last command wrote: all timed launches, and all builds.
struct Spent {
  double kernel_s = 0, build_s = 0;
};

Spent spent(const Scratch& scratch) {
  const std::string path = scratch.path("out.json");
  const Json results = parse_json(read_text_file(path), path);
  Spent all;
  for (const Json& cell : results["cells"]) {
    all.build_s += cell["build_s"].get<double>();
    for (const Json& row : cell["rows"])
      all.kernel_s += row["kernel_s"]["median"].get<double>() *
                      row["kernel_s"]["count"].get<double>() * row["runs_per_launch"].get<double>();
  }
  return all;
}

void default_study(State& state, std::vector<std::string>& missed) {
  const Scratch scratch;
  state.counters["first_s"] = run_command(scratch, "");
  state.counters["first_build_s"] = spent(scratch).build_s;
  double best = INFINITY;
  Spent warm;
  for (auto _ : state) {
    for (int run = 0; run < 3; ++run) {
      const double seconds = run_command(scratch, "");
      if (seconds >= best) continue;
      best = seconds;
      warm = spent(scratch);
    }
    state.SetIterationTime(best);
  }
  state.counters["seconds"] = best;
  state.counters["limit_s"] = kStudyLimit;
  state.counters["kernel_s"] = warm.kernel_s;
  state.counters["build_s"] = warm.build_s;
  if (best >= kStudyLimit)
    missed.push_back(fmt::format("default_study: {:.1f} s >= {} s", best, kStudyLimit));
  if (warm.kernel_s <= warm.build_s)
    missed.push_back(fmt::format("default_study: {:.2f} s in kernels, {:.2f} s in builds",
                                 warm.kernel_s, warm.build_s));
}

template <typename Body>
void add(const std::string& name, std::vector<std::string>& missed, Body body) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [body, name, &missed](State& state) {
                                 try {
                                   body(state);
                                 } catch (const std::exception& error) {
                                   state.SkipWithError(error.what());
                                   missed.push_back(fmt::format("{}: {}", name, error.what()));
                                 }
                               })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1);
}

}  // namespace

void register_launch_cost(std::vector<std::string>& missed) {
  for (const Precision precision : {Precision::fp32, Precision::fp64})
    for (const char* sampler : {"random", "sobol-owen", "sobol-lms-shift"})
      for (const unsigned log2_coordinates : {20U, 22U, 24U}) {
        const OverheadRow row{sampler, precision, log2_coordinates};
        add(fmt::format("launch_overhead/{}/{}/log2_coordinates:{}", precision_name(precision),
                        sampler, log2_coordinates),
            missed, [row, &missed](State& state) { launch_overhead(state, row, missed); });
        add(fmt::format("launches_together/{}/{}/log2_coordinates:{}", precision_name(precision),
                        sampler, log2_coordinates),
            missed, [row, &missed](State& state) { overhead_together(state, row, missed); });
      }
  add("first_row", missed, [&missed](State& state) { first_row(state, missed); });
  add("default_study", missed, [&missed](State& state) { default_study(state, missed); });
}

}  // namespace koksma::bench
