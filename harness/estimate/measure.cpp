#include "estimate/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "estimate/quantile.hpp"
#include "estimate/stopping.hpp"
#include "estimate/timed_launches.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

// A run launches a row at most this often: rank tests of single rows need so many
// (report/compare.hpp).
constexpr std::size_t kLaunchesOfRun = 16;
constexpr std::uint64_t kKurtosisSamples = 4096;  // of which the kurtosis of f is estimated

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Launches of a row: `most`, or as few as the study says.
std::size_t most_launches(const Cell& cell, std::size_t most) {
  return cell.launches ? std::min<std::size_t>(*cell.launches, most) : most;
}

double median_of_finite(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
      values.end());
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return quantile_of(values, 0.5);
}

}  // namespace

// One accumulator per replicate and moment.
struct PreparedCell::Sums {
  std::vector<ExactSum> values, squares;
};

PreparedCell::PreparedCell(const Catalog& catalog, Device& device, Device& exact_device, Plan plan)
    : catalog_(catalog), device_(device), plan_(std::make_unique<Plan>(std::move(plan))) {
  exact_ = compute_exact(exact_device, *plan_->integrand, plan_->cell.scene);
  plan_->request.dimension_order = exact_.dimension_order;
  calibration_ = std::make_unique<Calibration>(device);
  const auto start = Clock::now();
  integrator_ = std::make_unique<Integrator>(device, *plan_, exact_.coefficients);
  start_integrator();
  // The first launch finishes compilation on some implementations (PoCL): warm up here, before
  // anything is timed.
  y0_ = median_of_finite(integrator_->first_values());
  if (!plan_->stores_doubles()) y0_ = static_cast<float>(y0_);
  if (plan_->estimator->moments == 1) y0_ = 0;
  if (declares(plan_->sampler->validity, "iid") || plan_->estimator->interval == "normal")
    estimate_kurtosis_of_f();
  build_s_ = seconds_since(start) - integrator_->setup_s();
}

void PreparedCell::start_integrator() {
  const double typical = sampled_scale(context()).value_or(1);
  integrator_->count_against(blow_up_limit(exact_), typical > 0 ? typical : 1);
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

Row PreparedCell::first_launch(std::uint64_t n, TimedLaunches& timed) {
  Row row;
  row.n = n;
  row.log2_block = integrator_->log2_block(n);
  row.grid_limited = n > std::uint64_t{1} << plan_->coordinate_bits;
  integrator_->prepare(n);
  if (!plan_->sampler->extensible) timed.resume();  // a table was made since
  Sums sums;
  const auto start = Clock::now();
  const double kernel_s = once(n, sums), wall_s = seconds_since(start);
  row.kernel = row.wall = summarise_times({kernel_s});
  timed.add_merged(row, kernel_s, wall_s);
  summarise(sums, row);
  return row;
}

// Launches whose sums nobody reads, of rows short enough, are made many at a time
// (Integrator::times_together): waiting for each would take as long as they do. The shortest rows
// are run several times by each.
class PreparedCell::Together {
 public:
  Together(Integrator& integrator, double y0, std::vector<Row>& rows, TimedLaunches& timed)
      : integrator_(integrator), y0_(y0), rows_(rows), timed_(timed) {}

  // Launches of the row and their seconds, those still to be made among them.
  std::size_t count(std::size_t row) const {
    return rows_[row].kernel_times.size() + waiting_of(row);
  }
  double spent(std::size_t row) const {
    return timed_.spent(rows_[row].n) + static_cast<double>(waiting_of(row)) * seconds_of(row);
  }
  bool admits(std::size_t row) const {
    return rows_[row].runs_per_launch > 1 || (seconds_of(row) < kSecondsBetweenCalibrations &&
                                              integrator_.runs_at_once(rows_[row].n) > 0);
  }
  void add(std::size_t row) {
    waiting_.push_back(row);
    seconds_ += seconds_of(row);
    if (seconds_ >= kSecondsBetweenCalibrations) launch();
  }
  void launch() {
    if (waiting_.empty()) return;
    std::vector<RepeatedRun> launches;
    for (const std::size_t row : waiting_)
      launches.push_back({rows_[row].n, rows_[row].runs_per_launch});
    const auto start = Clock::now();
    const std::vector<double> run_s = integrator_.times_together(launches, y0_);
    const double wall = seconds_since(start);
    double total = 0;
    for (std::size_t i = 0; i < run_s.size(); ++i) total += run_s[i] * launches[i].runs;
    for (std::size_t i = 0; i < run_s.size(); ++i)
      timed_.add(rows_[waiting_[i]], run_s[i],
                 total > 0 ? wall * run_s[i] * launches[i].runs / total : 0);
    waiting_.clear();
    seconds_ = 0;
  }

 private:
  std::size_t waiting_of(std::size_t row) const {
    return static_cast<std::size_t>(std::count(waiting_.begin(), waiting_.end(), row));
  }
  // That a launch of the row is expected to take.
  double seconds_of(std::size_t row) const {
    const Row& r = rows_[row];
    const double run_s = r.kernel_times.empty() ? r.kernel.min : r.kernel_times.back();
    return r.runs_per_launch * run_s;
  }

  Integrator& integrator_;
  double y0_;
  std::vector<Row>& rows_;
  TimedLaunches& timed_;
  std::vector<std::size_t> waiting_;
  double seconds_ = 0;  // that they are expected to take
};

void PreparedCell::choose_runs(Row& row, TimedLaunches& timed) {
  const double fastest = *std::min_element(row.kernel_times.begin(), row.kernel_times.end());
  row.runs_per_launch = runs_of_launch(*integrator_, row.n, y0_, fastest);
  if (row.runs_per_launch == 1) return;
  row.kernel = summarise_times(row.kernel_times);
  timed.restart(row);
}

void PreparedCell::time_rounds(std::vector<Row>& rows, std::size_t first, std::size_t most_rounds,
                               double share, TimedLaunches& timed) {
  Sums sums;
  const PartialSums ignore = [](std::uint32_t, std::uint32_t, std::span<const double>) {};
  Together together(*integrator_, y0_, rows, timed);
  // How many runs a launch makes is chosen after the runs that are merged.
  const double share_merged =
      std::clamp(static_cast<double>(kMergedRuns) / static_cast<double>(most_rounds), share, 1.0);
  bool again = true;
  while (again) {
    again = false;
    for (std::size_t i = first; i < rows.size(); ++i) {
      const bool merged = timed.merged(rows[i].n) < kMergedRuns;
      if (!merged && timed.chooses_runs(rows[i].n)) choose_runs(rows[i], timed);
      if (enough_launches(together.count(i), together.spent(i), most_rounds,
                          merged ? share_merged : share))
        continue;
      again = true;
      if (!merged && together.admits(i)) {
        together.add(i);
        continue;
      }
      const auto start = Clock::now();
      const double kernel_s =
          merged ? once(rows[i].n, sums) : integrator_->run(rows[i].n, y0_, ignore);
      if (merged)
        timed.add_merged(rows[i], kernel_s, seconds_since(start));
      else
        timed.add(rows[i], kernel_s, seconds_since(start));
    }
  }
  together.launch();
  timed.pause();
}

Row PreparedCell::run_row(std::uint64_t n) {
  TimedLaunches timed(*calibration_);
  std::vector<Row> rows;
  rows.push_back(first_launch(n, timed));
  time_rounds(rows, 0, kLaunchesAlone, 1, timed);
  timed.finish(rows, 0);
  return std::move(rows.front());
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

// The same program with the tables of a larger N; the rows so far are its first points.
std::string PreparedCell::extend(std::uint64_t n) {
  Cell cell = plan_->cell;
  cell.n.push_back(n);
  PlanOptions options;
  options.shape = plan_->shape;
  options.relaxed_math = plan_->relaxed_math;
  options.counters = plan_->counters;
  options.coarse_coordinates = plan_->coarse_coordinates;
  try {
    auto plan = std::make_unique<Plan>(
        make_plan(catalog_, cell, device_.facts(), plan_->request.directions_file, options));
    if (plan->cell.n.back() != n) return "the precision can tell no more points apart";
    plan->refused_n = plan_->refused_n;
    plan->request.dimension_order = exact_.dimension_order;
    auto integrator = std::make_unique<Integrator>(device_, *plan, exact_.coefficients);
    earlier_setup_s_ += integrator_->setup_s();
    integrator_ = std::move(integrator);
    plan_ = std::move(plan);
    start_integrator();
    integrator_->first_values();           // warmed up, as the first was
  } catch (const std::exception& error) {  // what was measured so far stays
    return error.what();
  }
  return "";
}

// Every round launches each row once, so that a machine that slows down or speeds up does so for
// all of them. Sets that are built per N have one table at a time, and a rule that stops by time
// needs that of a row before it starts the next: their rows are timed one by one, in one pass.
Stopped PreparedCell::run_rows(const std::optional<Reference>& reference) {
  const Cell asked = plan_->cell;
  Cell unbounded = asked;
  unbounded.stop.beyond_n = std::uint64_t{1} << plan_->sampler->max_log2_n;
  std::vector<Timing> launches;
  StopFacts facts;
  facts.rule = asked.stop;
  facts.most_launches = most_launches(asked, kLaunchesAlone);
  const auto start = Clock::now();
  const std::size_t most = most_launches(asked, asked.stop.any() ? kLaunchesAlone : kLaunchesOfRun);
  const bool one_by_one = !plan_->sampler->extensible || asked.stop.any();
  if (one_by_one) pass_ = kPasses;
  const auto finished = [&](Stopped stopped) {
    if (!one_by_one) time_again();
    return stopped;
  };
  for (facts.n = asked.n.front();; facts.n = *facts.next) {
    rows_.push_back(first_launch(facts.n, *timed_));
    if (one_by_one) {
      time_rounds(rows_, rows_.size() - 1, most, 1, *timed_);
      timed_->finish(rows_, rows_.size() - 1);
    }
    launches.push_back({facts.n, rows_.back().wall.median});
    facts.launches = launches;
    facts.next = next_size(*plan_->sampler, asked, facts.n);
    facts.sampler_ends = !facts.next && !next_size(*plan_->sampler, unbounded, facts.n);
    facts.reached = reached_error(rows_.back(), exact_.mean, reference);
    facts.spent = seconds_since(start);
    if (const auto stopped = why_stop(facts)) return finished(*stopped);
    if (*facts.next <= plan_->cell.n.back()) continue;
    const std::string refusal = extend(*facts.next);
    if (!refusal.empty()) return finished(stopped_by_sampler(facts, refusal));
  }
}

void PreparedCell::start(const std::optional<Reference>& reference) {
  timed_ = std::make_unique<TimedLaunches>(*calibration_);
  rows_.clear();
  pass_ = 0;
  stopped_ = run_rows(reference);
}

void PreparedCell::time_again() {
  if (pass_ > 0) timed_->resume();
  ++pass_;
  const std::size_t most = most_launches(plan_->cell, kLaunchesOfRun);
  time_rounds(rows_, 0, most, static_cast<double>(pass_) / kPasses, *timed_);
  const bool enough = std::all_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    return enough_launches(row.kernel_times.size(), timed_->spent(row.n), most);
  });
  if (enough) pass_ = kPasses;  // few launches, or long ones
}

CellResult PreparedCell::result(std::size_t rows_of_run,
                                const std::optional<Reference>& reference) const {
  CellResult result;
  result.cell = plan_->cell;
  result.exact = exact_;
  result.build_s = build_s_;
  result.stopped = *stopped_;
  result.rows = rows_;
  timed_->finish(result.rows, 0);
  result.setup_s = earlier_setup_s_ + integrator_->setup_s();
  result.table_bytes = integrator_->table_bytes();
  result.coefficient_bytes = integrator_->coefficient_bytes();
  assess_cell(context(), reference, rows_of_run, result);
  return result;
}

CellResult PreparedCell::run(std::size_t rows_of_run, const std::optional<Reference>& reference) {
  start(reference);
  while (unfinished()) time_again();
  return result(rows_of_run, reference);
}

}  // namespace koksma
