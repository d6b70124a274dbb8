#include "estimate/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>
#include <utility>

namespace koksma {

namespace {

// False-alarm probability of the bias tests of one run (page 5, section 0).
constexpr double kBiasFalseAlarm = 1e-6;

// Times its bound the numerical solution has left the true one; times E|f| any f is beyond belief
// (page 5, section 0).
constexpr double kBlowUp = 10;
constexpr double kHuge = 1e30;

struct BiasTest {
  std::optional<double> z;
  bool significant = false, explained = false;
  std::string untested;  // why, else empty
};

// Why mean/(sd/√R) has not the distribution of Student's t here; empty if it has.
std::string why_no_t(const CellFacts& facts) {
  const ErrorStatistics& e = facts.errors;
  if (facts.infinite_variance) return "infinite variance";
  if (!e.bias || !e.rmse) return "no exact value";
  if (e.replicates < 2) return "one replicate";
  if (!e.sd || !(*e.sd > 0)) return "the replicates do not differ";
  if (e.heavy_tailed) return "heavy-tailed errors";
  if (!facts.unbounded_tail.empty()) return facts.unbounded_tail;
  if (facts.excess_of_mean && !(*facts.excess_of_mean < kLargestExcess))
    return "excess kurtosis / N is not below 0.1";
  // A normal row is lost in 1 of 100 cases. What is left of other tails could not reach 1e-6.
  if (e.kurtosis && !kurtosis_is_normal(*e.kurtosis, e.replicates))
    return "the errors are not normal";
  return "";
}

BiasTest test_bias(const CellFacts& facts, std::size_t rows_of_run) {
  BiasTest test;
  const ErrorStatistics& e = facts.errors;
  const auto size = static_cast<double>(e.replicates);
  if (e.bias && e.sd && *e.sd > 0 && !facts.infinite_variance)
    test.z = *e.bias / (*e.sd / std::sqrt(size));
  test.untested = why_no_t(facts);
  if (!test.untested.empty()) return test;
  // Independent replicates that all missed a spike of f agree with each other, though they should
  // not: they may not look more alike than the exact variance has them.
  const double sd = std::max(*e.sd, facts.exact_sd.value_or(0));
  test.significant = is_significant(*e.bias, sd, e.replicates, rows_of_run);
  test.explained = std::fabs(*e.bias) <= kFloorFactor * facts.floor;
  return test;
}

std::string nonfinite_samples(const CellFacts& facts) {
  return fmt::format("{} samples of all rows are not finite", facts.nonfinite);
}

// Of finite samples, too, as where a sum overflows.
std::string nonfinite_sums(const CellFacts& facts) {
  return fmt::format(
      "the sums of {} replicates of all rows are not finite, although every sample is: beyond the "
      "range of the sum (koksma list sums)",
      facts.nonfinite_replicates);
}

// Only a scheme that grows where the solution does not leaves its bound.
std::string why_unstable(const CellFacts& facts) {
  if (!facts.ode) return "";
  if (facts.nonfinite > 0) return nonfinite_samples(facts);
  if (facts.nonfinite_replicates > 0) return nonfinite_sums(facts);
  if (facts.blow_ups.value_or(0) > 0)
    return fmt::format("{} samples are above {} times the bound of the true solution",
                       *facts.blow_ups, kBlowUp);
  if (facts.bound && facts.largest > kBlowUp * *facts.bound)
    return fmt::format("a mean of {:.2g}: the true solution is at most {:.2g}", facts.largest,
                       *facts.bound);
  if (facts.mean_abs && facts.largest > kHuge * *facts.mean_abs)
    return fmt::format("a mean of {:.2g}, E|f| is {:.2g}", facts.largest, *facts.mean_abs);
  return "";
}

std::string why_faulty(const CellFacts& facts) {
  if (facts.nonfinite > 0) return nonfinite_samples(facts);
  if (facts.nonfinite_replicates > 0) return nonfinite_sums(facts);
  if (facts.out_of_range.value_or(0) > 0)
    return fmt::format("{} coordinates are outside the range of their set", *facts.out_of_range);
  if (facts.index_fault) return "a sample index was not used exactly once";
  return "";
}

std::string why_cell_unresolved(const CellFacts& facts) {
  ResolutionFacts resolution;
  resolution.infinite_variance = facts.infinite_variance;
  resolution.n_eff = facts.n_eff;
  resolution.empirical_n_eff = facts.empirical_n_eff;
  const double estimate = facts.errors.mean.value_or(1);
  resolution.hit_nothing =
      hit_nothing(facts.mean, facts.mean_abs, std::span(&estimate, 1), facts.hits);
  std::string reason = why_unresolved(resolution);
  if (reason.empty()) return facts.unresolved_row;
  if (resolution.hit_nothing) return reason;
  const bool exactly = facts.n_eff && !(*facts.n_eff >= kFewestEffective);
  return fmt::format("n_eff = {:.2g} of {} is below 30",
                     exactly ? *facts.n_eff : *facts.empirical_n_eff,
                     exactly ? "one replicate" : "the samples of one replicate");
}

void decide_on_errors(const CellFacts& facts, const BiasTest& bias, CellVerdict& result) {
  if (facts.plateau.kind != PlateauKind::none) {
    result.verdict =
        facts.plateau.kind == PlateauKind::numeric ? "PLATEAU_NUMERIC" : "PLATEAU_STRUCTURAL";
    result.reason = facts.plateau.reason;
    if (facts.plateau.kind == PlateauKind::numeric && !facts.floor_from.empty())
      result.reason += fmt::format(", that of the {}", facts.floor_from);
    return;
  }
  if (bias.significant && !bias.explained) {
    result.verdict = "BIASED";
    result.reason = fmt::format(
        "the mean error {:.2g} is {:.1f} standard errors, the estimated floor is {:.2g}",
        *facts.errors.bias, *result.z_bias, facts.floor);
    return;
  }
  if (facts.rate.verdict == "outside-gate") {
    result.verdict = "OUTSIDE_GATE";
    result.reason =
        facts.rate.reason.empty() ? "the rate is not the expected one" : facts.rate.reason;
    return;
  }
  result.verdict = "OK";
  if (facts.rate.verdict != "within-gate") {
    result.reason = "not gated: ";
    result.reason += facts.rate.verdict == "no-theory" ? "no expected rate" : facts.rate.reason;
  }
  if (bias.untested.empty() && !bias.significant) return;
  if (!result.reason.empty()) result.reason += "; ";
  if (!bias.untested.empty()) {
    result.reason += "bias not tested: " + bias.untested;
    return;
  }
  result.reason += "the bias is that of the floor";
  if (!facts.floor_from.empty()) result.reason += fmt::format(", {}", facts.floor_from);
}

// Of four or more equal replicates none holds more than half: what it met, the others missed, and
// all may have missed more.
bool one_rules(std::span<const double> variances) {
  constexpr std::size_t kFewest = 4;
  if (variances.size() < kFewest) return false;
  const double sum = std::accumulate(variances.begin(), variances.end(), 0.0);
  return *std::max_element(variances.begin(), variances.end()) > sum / 2;
}

}  // namespace

bool is_significant(double mean_error, double sd, std::size_t replicates, std::size_t rows_of_run) {
  const auto size = static_cast<double>(replicates);
  const boost::math::students_t distribution(size - 1);
  const double level = kBiasFalseAlarm / static_cast<double>(rows_of_run);
  const double limit = quantile(complement(distribution, level / 2));
  return std::fabs(mean_error) > limit * sd / std::sqrt(size);
}

bool hit_nothing(const std::optional<double>& mean, const std::optional<double>& mean_abs,
                 std::span<const double> estimates, const std::optional<std::uint64_t>& hits) {
  if (hits) return *hits == 0 && mean_abs.value_or(0) > 0;
  // Of an f of both signs 0 is an estimate like any other.
  return !estimates.empty() && mean && mean_abs && *mean > 0 && *mean == *mean_abs &&
         std::all_of(estimates.begin(), estimates.end(), [](double q) { return q == 0; });
}

std::string why_unresolved(const ResolutionFacts& facts) {
  if (facts.hit_nothing) return "every sample of f is 0";
  if (facts.infinite_variance) return "";
  // Written so that a NaN is unresolved.
  if (facts.n_eff && !(*facts.n_eff >= kFewestEffective)) return "n_eff below 30";
  if (facts.empirical_n_eff && !(*facts.empirical_n_eff >= kFewestEffective))
    return "n_eff of the samples below 30";
  // Where n_eff is known to be enough, the points are what is wrong.
  if (facts.n_eff || !facts.error || !facts.mean_abs) return "";
  const bool sampling = !(*facts.error < kFloorFactor * facts.floor);
  return sampling && !(*facts.error <= *facts.mean_abs / 2) ? "RMSE > E|f|/2" : "";
}

CellVerdict decide_verdict(const CellFacts& facts, std::size_t rows_of_run) {
  CellVerdict result;
  result.n_eff = facts.n_eff;
  result.empirical_n_eff = facts.empirical_n_eff;
  if (facts.overflows) result.marks.emplace_back("OVERFLOW");
  const auto decided = [&result](std::string_view verdict, std::string reason) {
    if (reason.empty()) return false;
    result.verdict = verdict;
    result.reason = std::move(reason);
    return true;
  };
  if (decided("NOT_INTEGRABLE", facts.mean_undefined ? "f has no mean" : "")) return result;
  if (decided("UNSTABLE_INTEGRATOR", why_unstable(facts))) return result;
  if (decided("DOMAIN_FAULT", why_faulty(facts))) return result;
  const BiasTest bias = test_bias(facts, rows_of_run);
  result.z_bias = bias.z;
  if (decided("UNRESOLVED", why_cell_unresolved(facts))) return result;
  if (!facts.mean) {
    result.reason = "no exact value";
    return result;
  }
  decide_on_errors(facts, bias, result);
  return result;
}

void qualify_interval(Estimate& estimate, const IntervalFacts& facts) {
  std::string why_none;
  if (facts.mean_undefined) {
    why_none = "no interval: f has no mean";
  } else if (facts.infinite_variance) {
    why_none = "no interval: the variance is infinite";
  } else if (!facts.unresolved.empty()) {
    why_none = "no interval: " + facts.unresolved;
  }
  if (!why_none.empty()) {
    // An estimator without intervals has said why.
    if (estimate.interval || estimate.standard_error) estimate.reason = why_none;
    estimate.standard_error.reset();
    estimate.interval.reset();
    return;
  }
  if (!estimate.interval) return;
  if (!facts.unbounded_tail.empty()) {
    estimate.reason = "may cover less: " + facts.unbounded_tail;
  } else if (one_rules(facts.variances)) {
    estimate.reason = "may cover less: one replicate holds most of the variance";
  } else if (facts.excess_of_mean && !(*facts.excess_of_mean < kLargestExcess)) {
    estimate.reason = "may cover less: excess kurtosis / N is not below 0.1";
  } else if (facts.heavy_tailed) {
    estimate.reason = "may cover more or less: heavy-tailed replicates";
  }
}

void drop_rmse_interval(ErrorStatistics& errors, std::string_view method) {
  errors.rmse_low.reset();
  errors.rmse_high.reset();
  errors.rmse_interval_method = method;
}

void drop_rmse(ErrorStatistics& errors) {
  errors.rmse.reset();
  errors.rmse_low.reset();
  errors.rmse_high.reset();
  errors.rmse_interval_method = {};
  errors.rho.reset();
}

}  // namespace koksma
