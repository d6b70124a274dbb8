#include "general.hpp"

#include <fmt/format.h>

#include <exception>

#include "device/compare_general.hpp"
#include "device/operations.hpp"
#include "error/error.hpp"
#include "plan/general.hpp"
#include "subject.hpp"

namespace koksma::bench {
namespace {

using State = benchmark::State;

// Three rounds that agree within 2 % may all be disturbed by so much on a shared machine.
constexpr double kNoise = 0.03;
constexpr double kDominated = 1.5;
// A neighbour on the same core is there for 1 to 3 s and slows down long loops without branches
// more than short ones: `random` in fp32 is 0.94 to 0.99 times as fast as its twin beside one, 1.01
// to 1.05 without.
constexpr Rounds kRounds{.most = 200000, .least_seconds = 4};

struct Row {
  std::string scene, sampler;
  Precision precision;
  std::uint64_t n;
  std::uint32_t replicates;
};

// Products, sums, paths and one stiff problem beside the samplers that have general kernels; small
// sets too, where seeking and stores weigh.
std::vector<Row> rows() {
  constexpr std::uint64_t large = std::uint64_t{1} << 16, small = std::uint64_t{1} << 8;
  std::vector<Row> result;
  for (const char* sampler : {"sobol", "sobol-shift", "sobol-owen", "lattice-shift",
                              "lattice-shift-tent", "kronecker-shift", "random"})
    result.push_back({"linear-prod:d=8", sampler, Precision::fp32, large, 8});
  for (const char* sampler : {"sobol-lms-shift", "lattice-shift", "random"})
    result.push_back({"linear-prod:d=8", sampler, Precision::fp64, large, 8});
  result.push_back({"linear-prod:d=64", "sobol-shift", Precision::fp32, large, 8});
  result.push_back({"sobol-g:d=3", "sobol-interlaced-2", Precision::fp64, large, 4});
  result.push_back({"exp-sum:d=8", "sobol-shift", Precision::fp32, large, 8});
  result.push_back({"exp-sum:d=8", "lattice-shift", Precision::fp32, large, 8});
  result.push_back({"asian-geometric-call-pca:d=16", "sobol-shift", Precision::fp32, large, 4});
  result.push_back({"flame", "sobol-shift", Precision::fp64, std::uint64_t{1} << 12, 4});
  result.push_back({"linear-prod:d=8", "sobol-shift", Precision::fp32, small, 32});
  return result;
}

Plan plan_of(const Row& row) {
  Cell cell;
  cell.scene = parse_scene(catalog(), row.scene, "benchmark");
  cell.sampler = row.sampler;
  const Sampler sampler = catalog().sampler(row.sampler, "benchmark");
  cell.estimator = sampler.default_estimator;
  cell.precision = row.precision;
  cell.n = {row.n};
  cell.replicates = sampler.replicable ? row.replicates : 1;
  cell.seed = 1;
  return make_plan(catalog(), cell, device().facts());
}

void compare(State& state, const Row& row, std::vector<std::string>& missed) {
  const Plan plan = plan_of(row);
  const ExactValues exact = compute_exact(device(), *plan.integrand, plan.cell.scene);
  const OperationCount count = count_operations(device(), catalog(), plan, exact.coefficients);
  GeneralComparison result;
  for (auto _ : state) {
    result = compare_with_general(device(), catalog(), plan, exact.coefficients, row.n, kRounds);
    state.SetIterationTime(result.planned_s);
  }
  const double required = count.points_dominate() ? kDominated : 1 - kNoise;
  state.counters["ratio"] = result.ratio();
  state.counters["required"] = required;
  state.counters["rounds"] = static_cast<double>(result.rounds);
  state.counters["point_operations"] = count.points();
  state.counters["integrand_operations"] = count.integrand();
  state.counters["planned_table_bytes"] = static_cast<double>(result.planned_table);
  state.counters["general_table_bytes"] = static_cast<double>(result.general_table);
  if (result.ratio() < required)
    missed.push_back(fmt::format("planned_vs_general/{}/{}: ratio {:.3f} < {}", row.scene,
                                 row.sampler, result.ratio(), required));
}

// What is unsupported here is no miss; any other failure is one.
void guarded(State& state, const Row& row, std::vector<std::string>& missed) {
  try {
    compare(state, row, missed);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    missed.emplace_back(fmt::format("{} {}: {}", row.scene, row.sampler, error.what()));
  }
}

}  // namespace

void register_planned_vs_general(std::vector<std::string>& missed) {
  for (const Row& row : rows()) {
    const std::string name = fmt::format("planned_vs_general/{}/{}/{}/n:{}", row.scene, row.sampler,
                                         precision_name(row.precision), row.n);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [row, &missed](State& state) { guarded(state, row, missed); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  }
}

}  // namespace koksma::bench
