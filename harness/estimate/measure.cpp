#include "estimate/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

// Repeat to 20 ms or 5 times, whichever comes first.
constexpr double kRepeatSeconds = 0.020;
constexpr std::size_t kRepeatCount = 5;
constexpr std::uint64_t kKurtosisSamples = 4096;  // of which the kurtosis of f is estimated

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double quantile_of(const std::vector<double>& sorted, double p) {
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

TimeStatistics summarise_times(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return {quantile_of(times, 0.5), times.front(),
          quantile_of(times, 0.75) - quantile_of(times, 0.25), times.size()};
}

double median_of_finite(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
      values.end());
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return quantile_of(values, 0.5);
}

// E|f|, or where it is unknown its bound sqrt(E f^2).
std::optional<double> scale_of(const ExactValues& exact) {
  if (exact.mean_abs) return exact.mean_abs;
  if (exact.mean && exact.variance) return std::hypot(*exact.mean, std::sqrt(*exact.variance));
  return std::nullopt;
}

// N (E|f|)^2 / E f^2, where the moments are known; 0 where E f^2 is above all numbers.
std::optional<double> effective_samples(const ExactValues& exact, std::uint64_t n) {
  if (exact.variance_overflows) return 0;
  if (!exact.mean || !exact.variance || !exact.mean_abs) return std::nullopt;
  const double second_moment = *exact.variance + *exact.mean * *exact.mean;
  if (second_moment <= 0) return std::nullopt;
  return static_cast<double>(n) * *exact.mean_abs * *exact.mean_abs / second_moment;
}

bool declares(const std::vector<std::string>& values, std::string_view value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

constexpr const char* kItself = "measured against itself";

// An error can not be seen below that of the reference.
double reference_floor(const CellResult& result) {
  return result.reference ? result.reference->error.value_or(0) : 0;
}

RateFit fit(const CellResult& result, const Plan& plan) {
  std::vector<ConvergenceRow> rows;
  const double truth = result.exact.mean ? *result.exact.mean : result.reference->value;
  ExactValues scale = result.exact;
  scale.mean = truth;  // rounding is relative to the estimate where that is all there is
  for (const Row& row : result.rows) {
    if (row.error_reason == kItself) continue;
    ConvergenceRow r;
    r.samples = row.n;
    for (const double q : row.estimates) r.errors.push_back(q - truth);
    r.floor = std::max(rounding_floor(plan, scale, row.n), reference_floor(result));
    r.mean_abs = scale_of(result.exact);
    r.n_eff = effective_samples(result.exact, row.n);
    rows.push_back(std::move(r));
  }
  FitOptions options;
  options.infinite_variance = result.exact.infinite_variance;
  RateFit fit = fit_rate(rows, options);
  // Its rows stay out of the fit, but what they are is not known.
  if (result.reference && !result.reference->error && fit.plateau.kind == PlateauKind::structural) {
    fit.plateau = {};
    fit.plateau.reason = "flat, which may be the error of the reference: it is unknown";
  }
  return fit;
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

double rounding_floor(const Plan& plan, const ExactValues& exact, std::uint64_t n) {
  const double scale = scale_of(exact).value_or(exact.mean ? std::fabs(*exact.mean) : 0);
  const double evaluation = plan.fp64() ? 0x1p-53 : 0x1p-24;
  const double accumulator = plan.stores_doubles() ? 0x1p-53 : 0x1p-24;
  const double per_lane =
      std::min(static_cast<double>(n), std::ldexp(1.0, static_cast<int>(log2_block_length(n)))) /
      16;
  const double additions = plan.sum->words > 1 ? 1 : std::max(per_lane, 1.0);
  return scale * (4 * evaluation + std::sqrt(additions) * accumulator);
}

// One accumulator per replicate and moment.
struct PreparedCell::Sums {
  std::vector<ExactSum> values, squares;
};

PreparedCell::PreparedCell(const Catalog& catalog, Device& device, Device& exact_device, Plan plan)
    : catalog_(catalog), plan_(std::make_unique<Plan>(std::move(plan))) {
  exact_ = compute_exact(exact_device, *plan_->integrand, plan_->cell.scene);
  plan_->request.dimension_order = exact_.dimension_order;
  const auto start = Clock::now();
  integrator_ = std::make_unique<Integrator>(device, *plan_, exact_.coefficients);
  const double typical = scale_of(exact_).value_or(1);
  integrator_->count_against(blow_up_limit(exact_), typical > 0 ? typical : 1);
  // The first launch finishes compilation on some implementations (PoCL): warm up here, before
  // anything is timed.
  y0_ = median_of_finite(integrator_->first_values());
  if (!plan_->stores_doubles()) y0_ = static_cast<float>(y0_);
  if (plan_->estimator->moments == 1) y0_ = 0;
  if (declares(plan_->sampler->validity, "iid") || plan_->estimator->interval == "normal")
    estimate_kurtosis_of_f();
  build_s_ = seconds_since(start) - integrator_->setup_s();
}

// Of a set that is built per N, the first values of a larger N are not spread over the cube: there
// it stays unknown.
void PreparedCell::estimate_kurtosis_of_f() {
  if (const auto stated = stated_kurtosis(*plan_->integrand, exact_)) {
    kurtosis_ = *stated;
    return;
  }
  if (!plan_->sampler->extensible && plan_->cell.n.front() > kKurtosisSamples) return;
  std::vector<double> values = integrator_->first_values(kKurtosisSamples);
  if (plan_->estimator->second_moment != "pair-means") {
    kurtosis_ = estimate_kurtosis(values, exact_.variance);
    return;
  }
  // The mean is one of N/2 terms, the means of samples 2i and 2i + 1.
  const std::size_t pairs = values.size() / 2;
  for (std::size_t i = 0; i < pairs; ++i) values[i] = (values[2 * i] + values[2 * i + 1]) / 2;
  values.resize(pairs);
  kurtosis_ = estimate_kurtosis(values, std::nullopt);
  if (kurtosis_.excess) *kurtosis_.excess *= 2;
}

double PreparedCell::once(std::uint64_t n, Sums& sums) {
  const std::uint32_t replicates = plan_->launched_replicates();
  sums.values.assign(replicates, ExactSum{});
  sums.squares.assign(plan_->estimator->moments == 2 ? replicates : 0, ExactSum{});
  return integrator_->run(
      n, y0_, [&](std::uint32_t word, std::uint32_t r, std::span<const double> partials) {
        (word < plan_->sum->words ? sums.values : sums.squares)[r].add(partials);
      });
}

Row PreparedCell::run_row(std::uint64_t n) {
  Row row;
  row.n = n;
  row.log2_block = integrator_->log2_block(n);
  row.grid_limited = n > std::uint64_t{1} << plan_->coordinate_bits;
  integrator_->prepare(n);
  Sums sums;
  std::vector<double> kernel, wall;
  double spent = 0;
  while (kernel.empty() || (kernel.size() < kRepeatCount && spent < kRepeatSeconds)) {
    const auto start = Clock::now();
    kernel.push_back(once(n, sums));
    wall.push_back(seconds_since(start));
    spent += wall.back();
  }
  row.kernel = summarise_times(std::move(kernel));
  row.wall = summarise_times(std::move(wall));
  summarise(sums, row);
  return row;
}

void PreparedCell::summarise(const Sums& sums, Row& row) {
  std::vector<double> estimates, variances;
  bool faulty = false;
  for (std::size_t r = 0; r < sums.values.size(); ++r) {
    faulty = faulty || sums.values[r].nonfinite() > 0;
    estimates.push_back(sums.values[r].rounded_quotient(row.n));
    if (sums.squares.empty()) continue;
    const double unit = plan_->stores_doubles() ? 0x1p-53 : 0x1p-24;
    const auto variance = variance_of_replicate(plan_->estimator->second_moment, row.n,
                                                sums.values[r], sums.squares[r], y0_, unit);
    if (variance) variances.push_back(*variance);
  }
  if (plan_->counters)
    row.counters = integrator_->counters();
  else if (faulty)
    row.counters = integrator_->count(catalog_, row.n);
  if (row.counters) {
    ExactSum total;
    for (const ExactSum& sum : sums.values) total.add(sum);
    row.nonfinite = row.counters->nonfinite();
    row.kappa = row.counters->kappa(total.rounded());
  }
  row.estimates = plan_->estimator->replicates_per_estimate > 1
                      ? group_medians(estimates, plan_->estimator->replicates_per_estimate)
                      : estimates;
  row.errors = summarise_errors(row.estimates, exact_.mean);
  row.estimate = summarise_estimate(*plan_->estimator, {estimates, variances, row.n});
  const auto n_eff = effective_samples(exact_, row.n);
  row.unresolved = !exact_.infinite_variance && n_eff && !(*n_eff >= kFewestEffective);
  qualify(row, variances);
  if (!declares(plan_->sampler->validity, "iid")) {
    row.mc_test.reason = "the samples are not independent";
    return;
  }
  if (!exact_.mean || !exact_.variance || !(*exact_.variance > 0)) {
    row.mc_test.reason = "no exact variance";
  } else if (row.unresolved) {
    row.mc_test.reason = "unresolved: n_eff below 30";
  } else if (!kurtosis_.unbounded.empty()) {
    row.mc_test.reason = kurtosis_.unbounded;
  } else if (!faulty) {
    std::vector<double> errors;
    for (const double q : row.estimates) errors.push_back(q - *exact_.mean);
    row.mc_test = test_mc_variance(errors, row.n, *exact_.variance, kurtosis_.excess);
  } else {
    row.mc_test.reason = "non-finite samples";
  }
}

// Errors against an estimate, where the integral is not known.
void PreparedCell::take_errors(CellResult& result,
                               const std::optional<Reference>& reference) const {
  if (exact_.mean || exact_.mean_undefined) return;
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
    if (exact_.infinite_variance) drop_rmse(row.errors);
    row.below_reference =
        row.errors.rmse && *row.errors.rmse < kFloorFactor * reference_floor(result);
    if (row.below_reference) row.error_reason = "below 3 x the error of the reference";
  }
}

// A single point set that is its own reference has no errors that a rate could be fitted to.
void PreparedCell::take_rate(CellResult& result) const {
  const bool itself = result.reference && result.reference->itself;
  if (itself && plan_->cell.replicates == 1) {
    result.rate.reason = kItself;
    for (const Row& row : result.rows) result.rate.excluded.push_back({row.n, kItself});
  } else if (exact_.mean || result.reference) {
    result.rate = fit(result, *plan_);
    if (itself) result.rate.excluded.push_back({result.rows.back().n, kItself});
  } else {
    result.rate.reason = "no exact value";
  }
}

// Takes back what the row's samples cannot support.
void PreparedCell::qualify(Row& row, const std::vector<double>& variances) const {
  const bool pooled = plan_->estimator->interval == "normal";
  const std::uint64_t samples = pooled ? row.n * plan_->cell.replicates : row.n;
  IntervalFacts facts;
  facts.mean_undefined = exact_.mean_undefined;
  facts.infinite_variance = exact_.infinite_variance;
  facts.n_eff = effective_samples(exact_, samples);
  if (kurtosis_.excess) facts.excess_of_mean = *kurtosis_.excess / static_cast<double>(samples);
  facts.unbounded_tail = kurtosis_.unbounded;
  facts.variances = variances;
  facts.heavy_tailed = !pooled && row.errors.heavy_tailed;
  qualify_interval(row.estimate, facts);
  if (exact_.infinite_variance) drop_rmse(row.errors);
}

CellFacts PreparedCell::facts_of(const CellResult& result) const {
  const Row& last = result.rows.back();
  const auto samples = static_cast<double>(last.n);
  CellFacts facts;
  facts.mean_undefined = exact_.mean_undefined;
  facts.infinite_variance = exact_.infinite_variance;
  facts.mean = exact_.mean;
  facts.mean_abs = exact_.mean_abs;
  for (const Row& row : result.rows) facts.nonfinite += row.nonfinite;
  facts.n_eff = effective_samples(exact_, last.n);
  facts.errors = last.errors;
  if (kurtosis_.excess) facts.excess_of_mean = *kurtosis_.excess / samples;
  facts.unbounded_tail = kurtosis_.unbounded;
  for (const ExcludedRow& row : result.rate.excluded)
    if (row.samples == last.n && row.reason.starts_with(kUnresolved))
      facts.unresolved_row = row.reason;
  if (exact_.variance && declares(plan_->sampler->validity, "iid"))
    facts.exact_sd = std::sqrt(*exact_.variance / samples);
  facts.floor = result.floor;
  facts.plateau = result.rate.plateau;
  facts.rate = result.verdict;
  return facts;
}

CellResult PreparedCell::run(std::size_t rows_of_run, const std::optional<Reference>& reference) {
  CellResult result;
  result.cell = plan_->cell;
  result.exact = exact_;
  result.build_s = build_s_;
  for (const std::uint64_t n : plan_->cell.n) result.rows.push_back(run_row(n));
  result.setup_s = integrator_->setup_s();
  result.table_bytes = integrator_->table_bytes();
  result.coefficient_bytes = integrator_->coefficient_bytes();
  take_errors(result, reference);
  result.floor = rounding_floor(*plan_, exact_, plan_->cell.n.back());
  take_rate(result);
  for (const std::uint64_t n : plan_->refused_n)
    result.rate.excluded.push_back({n, "not run: more points than the precision can tell apart"});
  const auto& expected = plan_->integrand->expected;
  const auto found = expected.find(rate_class(*plan_->sampler, *plan_->estimator));
  result.verdict = judge(result.rate,
                         found == expected.end()
                             ? std::nullopt
                             : std::optional(rate_at(found->second, plan_->cell.scene.parameters)),
                         plan_->cell.scene.dim);
  rows_of_run = std::max(rows_of_run, result.rows.size());
  if (declares(plan_->sampler->validity, "iid")) judge_variance(result, rows_of_run);
  result.stability = decide_verdict(facts_of(result), rows_of_run);
  return result;
}

}  // namespace koksma
