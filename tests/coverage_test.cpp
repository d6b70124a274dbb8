// Intervals of the estimators on real cells: 10^4 repetitions, each with randomizations of its own,
// against the interval's exact nominal level +- 1.5 points (6-definitions 14).
#include <catch2/catch.hpp>

#include "estimate/estimators.hpp"
#include "tests/support.hpp"

using namespace koksma;

namespace {

constexpr std::uint32_t kRepetitions = 10000;

struct Coverage {
  double level = 0;     // nominal
  double measured = 0;  // part of the repetitions whose interval holds the exact value
};

// Repetition k has the replicates k size … k size + size - 1 of one launch.
Coverage coverage(const std::string& scene, const std::string& sampler,
                  const std::string& estimator, std::uint64_t n, std::uint32_t size) {
  Cell cell = test::cell(scene, sampler, n, kRepetitions, estimator);
  const Plan probe = make_plan(test::catalog(), cell, test::device().facts());
  cell.replicates = kRepetitions * size / probe.estimator->replicates_per_estimate;
  const Plan plan = make_plan(test::catalog(), cell, test::device().facts());
  const ExactValues exact = compute_exact(test::device(), *plan.integrand, cell.scene);
  Integrator integrator(test::device(), plan, exact.coefficients);
  std::vector<ExactSum> sums(plan.launched_replicates()), squares(plan.launched_replicates());
  integrator.run(n, *exact.mean, [&](std::uint32_t word, std::uint32_t r, auto partials) {
    (word < plan.sum_words() ? sums : squares)[r].add(partials);
  });
  std::vector<double> estimates, variances;
  for (std::size_t r = 0; r < sums.size(); ++r) {
    estimates.push_back(sums[r].rounded_quotient(n));
    if (plan.estimator->moments == 2)
      variances.push_back(*variance_of_replicate(plan.estimator->second_moment, n, sums[r],
                                                 squares[r], *exact.mean, 0x1p-53));
  }
  Coverage result;
  std::size_t covered = 0;
  for (std::size_t k = 0; k < kRepetitions; ++k) {
    EstimatorInput input{std::span(estimates).subspan(k * size, size), {}, n};
    if (!variances.empty()) input.variances = std::span(variances).subspan(k * size, size);
    const Estimate estimate = summarise_estimate(*plan.estimator, input);
    REQUIRE(estimate.interval);
    result.level = estimate.level;
    covered += estimate.interval->low <= *exact.mean && *exact.mean <= estimate.interval->high;
  }
  result.measured = static_cast<double>(covered) / kRepetitions;
  return result;
}

}  // namespace

TEST_CASE("intervals cover the exact value with their nominal level, within 1.5 points",
          "[statistical]") {
  // Binomial sd at most 0.0022: a rightly covering interval fails with probability 1e-11 per row.
  // Fixed seed.
  struct Case {
    const char *scene, *sampler, *estimator;
    std::uint64_t n;
    std::uint32_t size;  // randomizations per interval
  };
  const Case cases[] = {
      {"genz-gaussian:d=2", "random", "mc", 1024, 1},
      {"genz-oscillatory:d=2", "random", "mc", 256, 4},
      {"genz-gaussian:d=2", "random-antithetic", "antithetic", 1024, 1},
      {"genz-gaussian:d=1", "sobol-owen", "rqmc", 64, 16},
      {"genz-gaussian:d=2", "sobol-owen", "rqmc", 64, 16},
      {"genz-oscillatory:d=2", "sobol-owen", "rqmc", 256, 16},
      {"genz-gaussian:d=2", "stratified-pairs", "stratified", 512, 1},
      {"genz-oscillatory:d=2", "stratified-pairs", "stratified", 512, 1},
      {"genz-gaussian:d=2", "sobol-lms-shift", "median", 64, 15},
      {"genz-oscillatory:d=2", "lattice-random", "median", 64, 15},
  };
  for (const Case& c : cases) {
    const Coverage found = coverage(c.scene, c.sampler, c.estimator, c.n, c.size);
    INFO(c.scene << " " << c.sampler << " " << c.estimator << " N = " << c.n << ": "
                 << found.measured << ", nominal " << found.level);
    CHECK(found.measured == Approx(found.level).margin(0.015));
  }
}
