#include "subject.hpp"

#include <numeric>

namespace koksma::bench {
namespace {

Plan plan_of(const SubjectSpec& spec) {
  Cell cell;
  cell.scene = parse_scene(catalog(), spec.scene, "benchmark");
  cell.sampler = spec.sampler;
  cell.estimator = catalog().sampler(spec.sampler, "benchmark").default_estimator;
  cell.precision = spec.precision;
  cell.n = {spec.end};
  cell.replicates = spec.replicates;
  cell.seed = 1;
  PlanOptions options;
  options.counters = spec.counters;
  return make_plan(catalog(), cell, device().facts(), "", options);
}

}  // namespace

const Catalog& catalog() {
  static const Catalog loaded = load_catalog({KOKSMA_BENCH_FOLDER "/plain-prod.json"});
  return loaded;
}

Device& device() {
  static Device chosen = Device::choose("");
  return chosen;
}

Subject::Subject(const SubjectSpec& spec)
    : plan_(plan_of(spec)),
      exact_(compute_exact(device(), *plan_.integrand, plan_.cell.scene)),
      integrator_(device(), plan_, exact_.coefficients) {
  // PoCL specialises a kernel at its first launch.
  run(std::uint64_t{1} << 10);
}

double Subject::run(std::uint64_t n) {
  double sum = 0;
  const double seconds = integrator_.run(
      n, 0, [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
        // Later words hold corrections and squares.
        if (word == 0) sum = std::accumulate(partials.begin(), partials.end(), sum);
        if (after_launch_) after_launch_();
      });
  mean_ = sum / (static_cast<double>(n) * plan_.cell.replicates);
  return seconds;
}

}  // namespace koksma::bench
