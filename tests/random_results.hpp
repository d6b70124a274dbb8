// Cells whose exact values, replicates and counts are made up at random, with faults planted
// anywhere; what was planted is kept, so that a test can tell what must follow. No device.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "estimate/assess.hpp"
#include "tests/numbers.hpp"
#include "tests/support.hpp"

namespace koksma::test {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  bool one_in(unsigned n) { return index(n) == 0; }
  std::size_t index(std::size_t n) { return std::size_t{engine_()} % n; }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  // Log-uniform over these powers of ten.
  double size(double low, double high) { return std::pow(10, uniform(low, high)); }
  double normal() { return normal_(engine_); }
  double bad() {
    const std::array values{std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity};
    return values[index(values.size())];
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

// A random cell, and what was planted in it.
struct Made {
  Plan plan;
  Integrand integrand;
  ExactValues exact;
  Kurtosis kurtosis;
  CellResult result;
  std::size_t bad_replicates = 0;       // in all rows
  std::vector<bool> bad_row, zero_row;  // all Q_r = 0
  bool blown_up = false;                // a mean or a counted sample above 10 times the bound
  bool out_of_range = false, index_fault = false;

  CellContext context() const { return {plan, exact, kurtosis}; }
};

// Plans of several estimators, made once.
inline const std::vector<Plan>& plans() {
  static const std::vector<Plan> made = [] {
    std::vector<Plan> list;
    for (const auto& [sampler, estimator] : {std::pair{"random", "mc"},
                                             {"sobol-owen", "rqmc"},
                                             {"sobol-lms-shift", "median"},
                                             {"sobol", "qmc"},
                                             {"halton", "qmc"},
                                             {"random-antithetic", ""}}) {
      for (const Precision precision : {Precision::fp32, Precision::fp64}) {
        Cell cell = test::cell(
            "linear-prod:d=2", sampler, 256,
            std::string(sampler).starts_with("s") || std::string(sampler).starts_with("r") ? 2 : 1,
            estimator);
        cell.precision = precision;
        list.push_back(make_plan(test::catalog(), cell, {}));
      }
    }
    return list;
  }();
  return made;
}

inline void draw_exact(Dice& dice, bool ode, ExactValues& exact) {
  const double scale = dice.size(-12, 12);
  if (!dice.one_in(12)) exact.mean = dice.one_in(8) ? 0.0 : scale * dice.uniform(-1, 1);
  if (dice.one_in(3) && exact.mean) exact.mean = std::fabs(*exact.mean);
  if (!dice.one_in(6))
    exact.mean_abs =
        exact.mean && dice.one_in(2) ? std::fabs(*exact.mean) : scale * dice.size(0, 2);
  if (dice.one_in(10)) {
    exact.infinite_variance = true;
  } else if (dice.one_in(12)) {
    exact.variance_overflows = true;
  } else if (!dice.one_in(6)) {
    exact.variance = dice.one_in(8) ? 0.0 : std::pow(scale * dice.size(-3, 3), 2);
  }
  if (dice.one_in(15)) {
    exact.mean_undefined = true;
    exact.mean.reset();
  }
  if (!ode) return;
  if (dice.one_in(2)) {
    exact.discrete_mean = exact.mean.value_or(scale) * dice.size(-1, 2);
    exact.discrete_mean_abs = std::fabs(*exact.discrete_mean);
    exact.discrete_variance = std::pow(scale * dice.size(-3, 3), 2);
  }
  exact.discrete_overflows = dice.one_in(8);
  if (dice.one_in(2)) exact.bound = scale * dice.size(0, 3);
  if (dice.one_in(2)) exact.stiffness = dice.size(-2, 6);
}

// One estimate of N samples.
struct Law {
  double centre = 0, size = 1, rate = -0.5, floor = 0;
};

inline std::vector<double> draw_estimates(Dice& dice, const Law& law, std::uint64_t n,
                                          std::size_t count) {
  std::vector<double> estimates;
  for (std::size_t r = 0; r < count; ++r)
    estimates.push_back(law.centre +
                        law.size * std::pow(static_cast<double>(n), law.rate) * dice.normal() +
                        law.floor * dice.normal());
  return estimates;
}

inline void draw_counters(Dice& dice, const std::vector<double>& estimates, bool bad, Made& made,
                          Row& row) {
  Counters k;
  k.samples = row.n * estimates.size();
  for (const double q : estimates) {
    if (std::isnan(q)) ++k.nan;
    if (std::isinf(q)) ++(q > 0 ? k.plus_inf : k.minus_inf);
  }
  k.hits = made.zero_row.back() ? 0 : 1 + dice.index(k.samples);
  if (dice.one_in(15)) k.coord_ge1 = 1;
  if (dice.one_in(5)) k.coord_le0 = 1;
  if (dice.one_in(20)) k.blow_ups = 1 + dice.index(100);
  if (!made.zero_row.back() && !bad) {
    k.sum_abs = dice.size(0, 6);
    k.sum_squares = k.sum_abs * k.sum_abs / dice.size(0, 6);
  }
  made.out_of_range =
      made.out_of_range || k.coord_ge1 > 0 || (made.plan.sampler->centred && k.coord_le0 > 0);
  made.blown_up = made.blown_up || k.blow_ups > 0;
  row.counters = k;
}

inline void draw_row(Dice& dice, const Law& law, std::uint64_t n, bool counted, Made& made) {
  Row row;
  row.n = n;
  const std::size_t count = made.plan.launched_replicates();
  std::vector<double> estimates = draw_estimates(dice, law, n, count);
  made.zero_row.push_back(dice.one_in(25));
  if (made.zero_row.back()) estimates.assign(count, 0.0);
  if (dice.one_in(25)) estimates.assign(count, estimates.front());
  bool bad = false;
  if (dice.one_in(25)) {
    bad = true;
    for (std::size_t i = 0, faults = 1 + dice.index(count); i < faults; ++i)
      estimates[dice.index(count)] = dice.bad();
    made.zero_row.back() = false;
  }
  made.bad_row.push_back(bad);
  for (const double q : estimates) {
    if (!std::isfinite(q)) ++made.bad_replicates;
    if (std::isfinite(q) && made.exact.bound && std::fabs(q) > 10 * *made.exact.bound)
      made.blown_up = made.plan.estimator->replicates_per_estimate == 1 || made.blown_up;
  }
  // A sum of finite samples may overflow: then no sample is at fault.
  if (bad && !dice.one_in(4)) row.nonfinite = made.bad_replicates;
  if (counted) draw_counters(dice, estimates, bad, made, row);
  if (counted) row.nonfinite = row.counters->nonfinite();
  std::vector<double> variances;
  if (made.plan.estimator->moments == 2)
    for (std::size_t r = 0; r < count; ++r)
      if (std::isfinite(estimates[r])) variances.push_back(std::pow(law.size * dice.normal(), 2));
  row.kernel.count = row.wall.count = 1;
  row.log2_block = 8;
  assess_row(made.context(), estimates, variances, row);
  made.result.rows.push_back(row);
}

inline void make(Dice& dice, Made& made) {
  const bool ode = dice.one_in(3);
  made.plan = plans()[dice.index(plans().size())];
  made.integrand = *made.plan.integrand;
  made.integrand.ode_size = ode ? 1 : 0;
  made.plan.integrand = &made.integrand;
  constexpr std::array<std::uint32_t, 4> kReplicates{1, 2, 8, 32};
  made.plan.cell.replicates = made.plan.estimator->name == "qmc" ? 1 : kReplicates[dice.index(4)];
  draw_exact(dice, ode, made.exact);
  if (dice.one_in(3)) made.kurtosis.excess = dice.size(-1, 5);
  if (dice.one_in(10)) made.kurtosis.unbounded = "nobody knows the tail";

  Law law;
  const double truth = made.exact.discrete_mean.value_or(made.exact.mean.value_or(1));
  const double scale = made.exact.mean_abs.value_or(std::fabs(truth) + 1e-3);
  law.centre = truth + (dice.one_in(4) ? scale * dice.size(-16, 0) : 0);
  law.size = scale * dice.size(-3, 1);
  law.rate = -dice.uniform(0, 3);
  if (dice.one_in(2)) law.floor = scale * dice.size(-17, -2);
  if (dice.one_in(15)) law.size = law.floor = 0;
  const unsigned first = 4 + static_cast<unsigned>(dice.index(8));
  const unsigned rows = 1 + static_cast<unsigned>(dice.index(11));
  const bool counted = dice.one_in(3);
  for (unsigned m = first; m < first + rows; ++m)
    draw_row(dice, law, (std::uint64_t{1} << m) + (dice.one_in(30) ? 1 : 0), counted, made);

  StabilityDetail& detail = made.result.detail;
  if (dice.one_in(4)) {
    detail.index = IndexFlags{!dice.one_in(20), !dice.one_in(20), !dice.one_in(20)};
    made.index_fault = !detail.index->sum_ok || !detail.index->sum_of_squares_ok ||
                       !detail.index->xor_of_hashes_ok;
  }
  for (std::optional<double>* floor : {&detail.floors.integrator, &detail.floors.coordinate,
                                       &detail.floors.integrand, &detail.floors.summation})
    if (dice.one_in(8)) *floor = dice.one_in(4) ? 0 : scale * dice.size(-18, -1);
  made.result.cell = made.plan.cell;
  made.result.stopped.reason = "all that were asked for";
  made.result.stopped.at_n = made.result.rows.back().n;
  made.result.exact = made.exact;
  std::optional<Reference> reference;
  if (dice.one_in(2)) {
    reference = Reference{};
    reference->value = truth;
    if (dice.one_in(2)) reference->error = scale * dice.size(-12, -1);
  }
  assess_cell(made.context(), reference, 100, made.result);
}

}  // namespace koksma::test
