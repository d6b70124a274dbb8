#include "speed_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <exception>
#include <map>
#include <memory>

#include "catalog/sizes.hpp"
#include "error/error.hpp"
#include "rounds.hpp"
#include "subject.hpp"

namespace koksma::bench {
namespace {

using State = benchmark::State;

constexpr const char* kYardstick = "sobol";
// Coordinates a launch: the yardstick takes 1 ms or less, long beside the 60 us that a launch
// costs. A slow sampler gets fewer, so that its launches find the processors of a busy machine free
// as often as the yardstick's do.
constexpr std::uint64_t kSpeedCoordinates = std::uint64_t{1} << 24;
constexpr std::uint64_t kFewestCoordinates = std::uint64_t{1} << 20;
constexpr std::uint32_t kSpeedReplicates = 4;
constexpr std::size_t kLeastSpeedRounds = 31, kMostRounds = 400;

struct SpeedRow {
  std::string sampler;
  Precision precision;
  std::uint32_t dim;
};

// The set nearest below kSpeedCoordinates coordinates that the sampler has, kept where it is at
// least a quarter of that.
SubjectSpec spec_of(const SpeedRow& row, std::uint64_t coordinates) {
  const Sampler s = catalog().sampler(row.sampler, "benchmark");
  const std::uint32_t replicates = s.replicable ? kSpeedReplicates : 1;
  const std::uint64_t wanted =
      std::min(coordinates / row.dim / replicates, std::uint64_t{1} << s.max_log2_n);
  const auto n = nearest_sizes(s, row.dim, wanted).below;
  if (!n || *n < wanted / 4)
    throw UnsupportedError(
        fmt::format("no set of about {} points in {} dimensions", wanted, row.dim));
  return {fmt::format("linear-prod:d={}", row.dim), row.sampler, row.precision, *n, replicates};
}

double coordinates_of(const SubjectSpec& spec, std::uint32_t dim) {
  return static_cast<double>(spec.end) * spec.replicates * dim;
}

// So many coordinates that a launch takes at most about twice the yardstick's.
std::uint64_t fair_coordinates(const SpeedRow& row, double yardstick_s) {
  const SubjectSpec spec = spec_of(row, kFewestCoordinates);
  Subject subject(spec);
  double best = subject.run(spec.end);
  for (int i = 0; i < 3; ++i) best = std::min(best, subject.run(spec.end));
  std::uint64_t coordinates = kFewestCoordinates;
  for (; coordinates < kSpeedCoordinates && best < yardstick_s; best *= 2) coordinates *= 2;
  return coordinates;
}

void measure(State& state, const SpeedRow& row, double required, std::vector<std::string>& missed) {
  const SubjectSpec yardstick_spec =
      spec_of({kYardstick, row.precision, row.dim}, kSpeedCoordinates);
  Subject yardstick(yardstick_spec);
  const SubjectSpec spec = spec_of(row, fair_coordinates(row, yardstick.run(yardstick_spec.end)));
  Subject subject(spec);
  Fastest subject_s, yardstick_s;
  std::size_t rounds = 0;
  for (auto _ : state) {
    while (rounds < kLeastSpeedRounds ||
           (rounds < kMostRounds && !(subject_s.settled() && yardstick_s.settled()))) {
      subject_s.add(subject.run(spec.end));
      yardstick_s.add(yardstick.run(yardstick_spec.end));
      ++rounds;
    }
    state.SetIterationTime(subject_s.best());
  }
  const double speed = coordinates_of(spec, row.dim) / subject_s.best();
  const double yardstick_speed = coordinates_of(yardstick_spec, row.dim) / yardstick_s.best();
  const double ratio = speed / yardstick_speed;
  state.counters["coordinates/s"] = speed;
  state.counters["yardstick/s"] = yardstick_speed;
  state.counters["ratio"] = ratio;
  state.counters["rounds"] = static_cast<double>(rounds);
  if (required <= 0) return;
  state.counters["required"] = required;
  if (ratio < required)
    missed.push_back(fmt::format("{} {} d = {}: ratio {:.3f} < {}", row.sampler,
                                 precision_name(row.precision), row.dim, ratio, required));
}

// What is unsupported here is no miss; any other failure is one.
void speed(State& state, const SpeedRow& row, double required, std::vector<std::string>& missed) {
  try {
    measure(state, row, required, missed);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    missed.emplace_back(fmt::format("{}: {}", row.sampler, error.what()));
  }
}

}  // namespace

void register_speed_table(std::vector<std::string>& missed) {
  for (const Sampler& s : catalog().samplers) {
    const bool needs_more = std::any_of(s.parameters.begin(), s.parameters.end(),
                                        [](const SamplerParameter& p) { return p.required; });
    if (needs_more) continue;
    for (const std::string& precision : s.precisions) {
      const auto asked = s.speed.find(precision);
      const double required = asked == s.speed.end() ? 0 : asked->second;
      for (const std::uint32_t dim : {2U, 8U, 64U}) {
        if (dim > s.max_dim || dim < s.min_dim) continue;
        const SpeedRow row{s.name, precision == "fp32" ? Precision::fp32 : Precision::fp64, dim};
        const std::string name = fmt::format("speed/{}/{}/d:{}", s.name, precision, dim);
        benchmark::RegisterBenchmark(
            name.c_str(),
            [row, required, &missed](State& state) { speed(state, row, required, missed); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond)
            ->Iterations(1);
      }
    }
  }
}

}  // namespace koksma::bench
