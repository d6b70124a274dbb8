#include "counters_cost.hpp"

#include <fmt/format.h>

#include <chrono>
#include <exception>

#include "rounds.hpp"
#include "study/study.hpp"
#include "subject.hpp"

namespace koksma::bench {
namespace {

using State = benchmark::State;

constexpr double kAllowed = 0.15;
// Both alternate at least this often, and on until all minima are met three times or the time is
// up: a cell takes 1 to 300 ms.
constexpr std::size_t kLeastRounds = 7;
constexpr double kSeconds = 3;

struct Seconds {
  double plain = 0, counting = 0;
};

// Sums over the cells that have run.
Seconds& total() {
  static Seconds of_all;
  return of_all;
}

SubjectSpec spec_of(const Cell& cell, bool counters) {
  return {cell.scene.text, cell.sampler,    cell.precision.value_or(Precision::fp64),
          cell.n.back(),   cell.replicates, counters};
}

// The fastest of every N, summed.
struct Sizes {
  std::vector<Fastest> fastest;
  double sum() const {
    double seconds = 0;
    for (const Fastest& one : fastest) seconds += one.best();
    return seconds;
  }
};

Seconds measure(State& state, const Cell& cell) {
  Subject plain(spec_of(cell, false)), counting(spec_of(cell, true));
  Sizes plain_s{std::vector<Fastest>(cell.n.size())}, counting_s = plain_s;
  std::size_t rounds = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    for (; rounds < kLeastRounds || seconds() < kSeconds; ++rounds) {
      for (std::size_t i = 0; i < cell.n.size(); ++i) {
        plain_s.fastest[i].add(plain.run(cell.n[i]));
        counting_s.fastest[i].add(counting.run(cell.n[i]));
      }
      if (rounds + 1 >= kLeastRounds && plain_s.fastest.back().settled() &&
          counting_s.fastest.back().settled())
        break;
    }
    state.SetIterationTime(counting_s.sum());
  }
  state.counters["rounds"] = static_cast<double>(rounds);
  return {plain_s.sum(), counting_s.sum()};
}

void report(State& state, const Seconds& seconds) {
  state.counters["plain_s"] = seconds.plain;
  state.counters["counting_s"] = seconds.counting;
  state.counters["slower"] = seconds.counting / seconds.plain - 1;
}

void cost_of_cell(State& state, const Cell& cell, std::vector<std::string>& missed) {
  try {
    const Seconds seconds = measure(state, cell);
    total().plain += seconds.plain;
    total().counting += seconds.counting;
    report(state, seconds);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    missed.emplace_back(error.what());
  }
}

void cost_of_study(State& state, std::vector<std::string>& missed) {
  for (auto _ : state) state.SetIterationTime(total().counting);
  if (total().plain == 0) {
    state.SkipWithError("none of its cells was selected");
    return;
  }
  report(state, total());
  state.counters["allowed"] = kAllowed;
  const double slower = total().counting / total().plain - 1;
  if (slower > kAllowed)
    missed.push_back(fmt::format("counters: {:.3f} slower > {}", slower, kAllowed));
}

}  // namespace

void register_counters_cost(std::vector<std::string>& missed) {
  const auto add = [](const std::string& name, auto&& call) {
    benchmark::RegisterBenchmark(name.c_str(), call)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  };
  const Study study = read_study(catalog(), "", {});
  for (const Cell& cell : study.cells)
    add(fmt::format("counters/{}/{}", cell.scene.text, cell.sampler),
        [cell, &missed](State& state) { cost_of_cell(state, cell, missed); });
  add("counters/default-study", [&missed](State& state) { cost_of_study(state, missed); });
}

}  // namespace koksma::bench
