#include "estimate/assess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace koksma {
namespace {

constexpr const char* kItself = "measured against itself";

bool is_finite(double value) { return std::isfinite(value); }

// An error can not be seen below that of the reference.
double reference_floor(const CellResult& result) {
  return result.reference ? result.reference->error.value_or(0) : 0;
}

// The error of what is sampled alone, where it can be told from that of the integrator.
std::optional<double> sampling_error(const CellContext& context, const Row& row) {
  if (!solves_ode(context)) return row.errors.rmse;
  return report_ode(row.estimates, context.exact.mean, context.exact.discrete_mean).sampling_rmse;
}

// Of the samples of one replicate that were seen, where they were counted.
std::optional<double> empirical_n_eff(const CellContext& context, const Row& row) {
  const auto n_eff = row.counters ? row.counters->n_eff() : std::nullopt;
  if (!n_eff) return std::nullopt;
  return *n_eff / context.plan.launched_replicates();
}

std::optional<std::uint64_t> hits_of(const Row& row) {
  return row.counters ? std::optional(row.counters->hits) : std::nullopt;
}

std::string why_row_unresolved(const CellContext& context, const Row& row) {
  const SampledMoments f = sampled_moments(context);
  ResolutionFacts facts;
  facts.infinite_variance = context.exact.infinite_variance;
  facts.n_eff = effective_samples(context, row.n);
  facts.empirical_n_eff = empirical_n_eff(context, row);
  facts.hit_nothing = hit_nothing(f.mean, f.mean_abs, row.estimates, hits_of(row));
  facts.error = sampling_error(context, row);
  facts.mean_abs = sampled_scale(context);
  facts.floor = formula_floors(context, row.n).predicted_total();
  return why_unresolved(facts);
}

// Takes back what the row's samples cannot support.
void qualify(const CellContext& context, std::span<const double> variances, Row& row) {
  const bool pooled = context.plan.estimator->interval == "normal";
  const std::uint64_t samples = pooled ? row.n * context.plan.cell.replicates : row.n;
  IntervalFacts facts;
  facts.mean_undefined = context.exact.mean_undefined;
  facts.infinite_variance = context.exact.infinite_variance;
  facts.unresolved = row.unresolved;
  if (pooled) {
    // The N R values are one sample, which may be resolved where N are not.
    const SampledMoments f = sampled_moments(context);
    ResolutionFacts pool;
    pool.n_eff = effective_samples(context, samples);
    if (row.counters) pool.empirical_n_eff = row.counters->n_eff();
    pool.hit_nothing = hit_nothing(f.mean, f.mean_abs, row.estimates, hits_of(row));
    pool.error = row.estimate.standard_error;
    pool.mean_abs = sampled_scale(context);
    facts.unresolved = why_unresolved(pool);
  }
  if (context.kurtosis.excess)
    facts.excess_of_mean = *context.kurtosis.excess / static_cast<double>(samples);
  facts.unbounded_tail = context.kurtosis.unbounded;
  facts.variances = variances;
  facts.heavy_tailed = !pooled && row.errors.heavy_tailed;
  qualify_interval(row.estimate, facts);
  if (!row.unresolved.empty()) drop_rmse_interval(row.errors, "unresolved");
  if (context.exact.infinite_variance) drop_rmse(row.errors);
}

// Independent points have a known variance, which is that of what is sampled.
McTest variance_test(const CellContext& context, const Row& row) {
  const SampledMoments f = sampled_moments(context);
  McTest test;
  if (!declares(context.plan.sampler->validity, "iid")) {
    test.reason = "the samples are not independent";
  } else if (solves_ode(context) && !f.discrete) {
    test.reason = "the variance of the numerical solution is not known";
  } else if (!f.mean || !f.variance || !(*f.variance > 0)) {
    test.reason = "no exact variance";
  } else if (!row.unresolved.empty()) {
    test.reason = fmt::format("{}{}", kUnresolved, row.unresolved);
  } else if (!context.kurtosis.unbounded.empty()) {
    test.reason = context.kurtosis.unbounded;
  } else if (row.nonfinite > 0 || row.errors.nonfinite > 0) {
    test.reason = "non-finite samples";
  } else {
    std::vector<double> errors;
    for (const double q : row.estimates) errors.push_back(q - *f.mean);
    test = test_mc_variance(errors, row.n, *f.variance, context.kurtosis.excess);
  }
  return test;
}

// Errors against an estimate, where the integral is not known.
void take_errors(const CellContext& context, const std::optional<Reference>& reference,
                 CellResult& result) {
  const ExactValues& exact = context.exact;
  if (exact.mean || exact.mean_undefined) return;
  const Row& last = result.rows.back();
  if (reference) {
    result.reference = reference;
  } else if (last.estimate.value) {
    result.reference =
        make_reference(*last.estimate.value, last.estimate.standard_error, last.estimate.interval,
                       fmt::format("this cell at N = {}", last.n));
    result.reference->itself = true;
  }
  if (!result.reference) return;
  for (Row& row : result.rows) {
    if (result.reference->itself && &row == &last) {
      row.error_reason = kItself;  // the errors stay those without an exact value: none
      continue;
    }
    row.errors = summarise_errors(row.estimates, result.reference->value);
    if (!row.unresolved.empty()) drop_rmse_interval(row.errors, "unresolved");
    if (exact.infinite_variance) drop_rmse(row.errors);
    row.below_reference =
        row.errors.rmse && *row.errors.rmse < kFloorFactor * reference_floor(result);
    if (row.below_reference) row.error_reason = "below 3 x the error of the reference";
  }
}

// Mean error of an integrator whose own mean is not known: that of the largest N, where it is no
// chance and the same at the N before, as no sampling error would be.
std::optional<double> seen_bias(const CellContext& context, std::size_t rows_of_run,
                                const CellResult& result) {
  if (!solves_ode(context) || context.exact.discrete_mean || result.rows.size() < 2)
    return std::nullopt;
  const ErrorStatistics& last = result.rows.back().errors;
  const ErrorStatistics& before = result.rows[result.rows.size() - 2].errors;
  if (!last.bias || !last.sd || !before.bias || last.replicates < 2) return std::nullopt;
  if (!is_significant(*last.bias, *last.sd, last.replicates, rows_of_run)) return std::nullopt;
  if (!(std::fabs(*last.bias - *before.bias) <= std::fabs(*last.bias) / 2)) return std::nullopt;
  return last.bias;
}

struct FloorsOf {
  const CellContext& context;
  const CellResult& result;
  std::optional<double> mean_error;

  Floors operator()(std::uint64_t n) const {
    return formula_floors(context, n, result.detail.floors, result.reference, mean_error);
  }
};

RateFit fit(const CellContext& context, const CellResult& result, const FloorsOf& floors) {
  std::vector<ConvergenceRow> rows;
  const double truth = context.exact.mean ? *context.exact.mean : result.reference->value;
  for (const Row& row : result.rows) {
    if (row.error_reason == kItself) continue;
    ConvergenceRow r;
    r.samples = row.n;
    for (const double q : row.estimates) r.errors.push_back(q - truth);
    r.floor = floors(row.n).predicted_total();
    r.mean_abs = sampled_scale(context);
    r.n_eff = effective_samples(context, row.n);
    r.unresolved = row.unresolved;
    rows.push_back(std::move(r));
  }
  FitOptions options;
  options.infinite_variance = context.exact.infinite_variance;
  RateFit fit = fit_rate(rows, options);
  // Its rows stay out of the fit, but what they are is not known.
  if (result.reference && !result.reference->error && fit.plateau.kind == PlateauKind::structural) {
    fit.plateau = {};
    fit.plateau.reason = "flat, which may be the error of the reference: it is unknown";
  }
  return fit;
}

// A single point set that is its own reference has no errors that a rate could be fitted to.
RateFit take_rate(const CellContext& context, const CellResult& result, const FloorsOf& floors) {
  const Plan& plan = context.plan;
  const bool itself = result.reference && result.reference->itself;
  RateFit rate;
  if (itself && plan.cell.replicates == 1) {
    rate.reason = kItself;
    for (const Row& row : result.rows) rate.excluded.push_back({row.n, kItself});
  } else if (context.exact.mean || result.reference) {
    rate = fit(context, result, floors);
    if (itself) rate.excluded.push_back({result.rows.back().n, kItself});
  } else {
    rate.reason = "no exact value";
  }
  for (const std::uint64_t n : plan.refused_n)
    rate.excluded.push_back({n, "not run: more points than the precision can tell apart"});
  return rate;
}

// Independent points are judged by their exact variance, which is sharper than any slope: every
// applicable row at level 1e-6 / rows of the run.
void judge_variance(CellResult& result, std::size_t rows_of_run) {
  std::size_t applicable = 0;
  bool contradicted = false;
  for (const Row& row : result.rows) {
    if (row.mc_test.applicable) ++applicable;
    contradicted = contradicted || contradicts_variance(row.mc_test, rows_of_run);
  }
  if (applicable == 0) return;
  result.verdict.verdict = contradicted ? "outside-gate" : "within-gate";
  result.verdict.reason = "chi-squared test against the exact variance";
}

RateVerdict judge_rate(const CellContext& context, const RateFit& rate) {
  const Plan& plan = context.plan;
  const auto& expected = plan.integrand->expected;
  const auto found = expected.find(rate_class(*plan.sampler, *plan.estimator));
  return judge(rate,
               found == expected.end()
                   ? std::nullopt
                   : std::optional(rate_at(found->second, plan.cell.scene.parameters)),
               plan.cell.scene.dim);
}

CellFacts facts_of(const CellContext& context, const CellResult& result) {
  const ExactValues& exact = context.exact;
  const SampledMoments f = sampled_moments(context);
  const Row& last = result.rows.back();
  const auto samples = static_cast<double>(last.n);
  CellFacts facts;
  facts.mean_undefined = exact.mean_undefined;
  facts.infinite_variance = exact.infinite_variance;
  facts.overflows = exact.discrete_overflows || exact.variance_overflows;
  facts.mean = exact.mean;
  facts.mean_abs = exact.mean_abs;
  facts.ode = solves_ode(context);
  facts.bound = exact.bound;
  for (const Row& row : result.rows) {
    facts.nonfinite += row.nonfinite;
    facts.nonfinite_replicates += row.errors.nonfinite;
    for (const double q : row.estimates) facts.largest = std::max(facts.largest, std::fabs(q));
    if (!row.counters) continue;
    const Counters& k = *row.counters;
    facts.blow_ups = facts.blow_ups.value_or(0) + k.blow_ups;
    facts.out_of_range = facts.out_of_range.value_or(0) + k.coord_ge1 +
                         (context.plan.sampler->centred ? k.coord_le0 : 0);
  }
  facts.hits = hits_of(last);
  if (result.detail.index)
    facts.index_fault = !result.detail.index->sum_ok || !result.detail.index->sum_of_squares_ok ||
                        !result.detail.index->xor_of_hashes_ok;
  facts.n_eff = effective_samples(context, last.n);
  facts.empirical_n_eff = empirical_n_eff(context, last);
  facts.errors = last.errors;
  if (context.kurtosis.excess) facts.excess_of_mean = *context.kurtosis.excess / samples;
  facts.unbounded_tail = context.kurtosis.unbounded;
  facts.unresolved_row = last.unresolved;
  if (f.variance && declares(context.plan.sampler->validity, "iid"))
    facts.exact_sd = std::sqrt(*f.variance / samples);
  facts.floor = result.floor;
  facts.floor_from = result.floors.dominant();
  facts.plateau = result.rate.plateau;
  facts.rate = result.verdict;
  return facts;
}

// What a differential equation adds to the report on the largest N.
void take_integrator(const CellContext& context, const CellFacts& facts, CellResult& result) {
  if (!solves_ode(context)) return;
  const ExactValues& exact = context.exact;
  result.ode = report_ode(result.rows.back().estimates, exact.mean, exact.discrete_mean);
  result.ode->blow_ups = facts.blow_ups;
  // Steps that follow a tolerance are not known.
  if (context.solver == nullptr || context.solver->adaptive) return;
  result.ode->stiffness = exact.stiffness;
  if (exact.stiffness)
    result.ode->max_abs_r =
        largest_growth(context.solver->numerator, context.solver->denominator, *exact.stiffness);
}

}  // namespace

std::string_view status_name(CellStatus status) {
  switch (status) {
    case CellStatus::ok:
      return "ok";
    case CellStatus::skipped:
      return "skipped";
    case CellStatus::unsupported:
      return "unsupported";
    case CellStatus::failed:
      break;
  }
  return "failed";
}

void assess_row(const CellContext& context, std::span<const double> estimates,
                std::span<const double> variances, Row& row) {
  const Estimator& estimator = *context.plan.estimator;
  row.estimates = estimator.replicates_per_estimate > 1
                      ? group_medians(estimates, estimator.replicates_per_estimate)
                      : std::vector<double>(estimates.begin(), estimates.end());
  // A sum that swallowed a sample which is not finite is none.
  std::vector<double> all(estimates.begin(), estimates.end());
  if (row.nonfinite > 0 && std::all_of(all.begin(), all.end(), is_finite)) {
    std::fill(all.begin(), all.end(), NAN);
    std::fill(row.estimates.begin(), row.estimates.end(), NAN);
  }
  row.errors = summarise_errors(row.estimates, context.exact.mean);
  row.estimate = summarise_estimate(estimator, {all, variances, row.n});
  row.unresolved = why_row_unresolved(context, row);
  qualify(context, variances, row);
  row.mc_test = variance_test(context, row);
}

void assess_cell(const CellContext& context, const std::optional<Reference>& reference,
                 std::size_t rows_of_run, CellResult& result) {
  take_errors(context, reference, result);
  rows_of_run = std::max(rows_of_run, result.rows.size());
  const FloorsOf floors{context, result, seen_bias(context, rows_of_run, result)};
  result.floors = floors(result.rows.back().n);
  result.floor = result.floors.predicted_total();
  result.rate = take_rate(context, result, floors);
  result.verdict = judge_rate(context, result.rate);
  if (declares(context.plan.sampler->validity, "iid")) judge_variance(result, rows_of_run);
  const CellFacts facts = facts_of(context, result);
  take_integrator(context, facts, result);
  result.stability = decide_verdict(facts, rows_of_run);
}

}  // namespace koksma
