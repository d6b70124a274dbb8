// The harness's own kernels as the benchmark runs them: one cell of one size, built, uploaded and
// warmed up.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "plan/plan.hpp"

namespace koksma::bench {

// With the integrands of this folder.
const Catalog& catalog();
// The default device (PoCL), opened once.
Device& device();

struct SubjectSpec {
  std::string scene, sampler;
  Precision precision = Precision::fp64;
  std::uint64_t end = 1;  // the largest N that will be run
  std::uint32_t replicates = 1;
  bool counters = false;  // the kernel counts its samples too
};

class Subject {
 public:
  // UnsupportedError when the device lacks the precision or the sampler the resolution.
  explicit Subject(const SubjectSpec& spec);
  // integrator_ refers to plan_.
  Subject(const Subject&) = delete;
  Subject& operator=(const Subject&) = delete;

  // Sums the first n samples of every replicate; returns the seconds of the kernels by the device's
  // clock.
  double run(std::uint64_t n);
  // The mean over all samples of the last run.
  double mean() const { return mean_; }
  // Called after every launch, when set.
  void after_launch(std::function<void()> call) { after_launch_ = std::move(call); }

  const Plan& plan() const { return plan_; }
  const std::vector<double>& coefficients() const { return exact_.coefficients; }
  std::uint32_t log2_block(std::uint64_t n) const { return integrator_.log2_block(n); }

 private:
  Plan plan_;
  ExactValues exact_;
  Integrator integrator_;
  std::function<void()> after_launch_;
  double mean_ = 0;
};

}  // namespace koksma::bench
