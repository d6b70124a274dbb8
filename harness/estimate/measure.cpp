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

bool declares(const std::vector<std::string>& values, std::string_view value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

}  // namespace

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
  const double typical = sampled_scale(context()).value_or(1);
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
    kurtosis_ = estimate_kurtosis(values, sampled_moments(context()).variance);
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
        (word < plan_->sum_words() ? sums.values : sums.squares)[r].add(partials,
                                                                        plan_->word_exponent(word));
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
  assess_row(context(), estimates, variances, row);
}

CellContext PreparedCell::context() const {
  const std::string* solver = solver_of(*plan_->integrand, plan_->cell.scene.choices);
  return {*plan_, exact_, kurtosis_, solver == nullptr ? nullptr : &catalog_.solver(*solver)};
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
  assess_cell(context(), reference, rows_of_run, result);
  return result;
}

}  // namespace koksma
