// Runs one prepared cell: partial sums -> exact merge -> replicates -> statistics, with times
// beside every error.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "estimate/convergence.hpp"
#include "estimate/estimators.hpp"
#include "estimate/kurtosis.hpp"
#include "estimate/mc_test.hpp"
#include "estimate/reference.hpp"
#include "estimate/stability.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

// Seconds of repeated launches.
struct TimeStatistics {
  double median = 0, min = 0;
  double spread = 0;  // interquartile range
  std::size_t count = 0;
};

struct Row {
  std::uint64_t n = 0;  // samples per replicate
  std::uint32_t log2_block = 0;
  std::vector<double> estimates;  // Q_r
  bool unresolved = false;        // n_eff < 30 in one replicate: its errors mean nothing
  ErrorStatistics errors;
  Estimate estimate;
  McTest mc_test;
  std::uint64_t nonfinite = 0;  // samples, all replicates
  // Of all replicates: where the plan has counters, or a partial sum is not finite.
  std::optional<Counters> counters;
  std::optional<double> kappa;   // sum |f| / |sum f|, where counted
  bool grid_limited = false;     // more points than the coordinates can tell apart
  bool below_reference = false;  // the RMSE is below 3 x the error of the reference
  std::string error_reason;      // why there are no errors, or none to believe
  TimeStatistics kernel, wall;   // of one launch of all replicates
};

enum class CellStatus { ok, skipped, unsupported, failed };
std::string_view status_name(CellStatus status);

struct CellResult {
  Cell cell;
  CellStatus status = CellStatus::ok;
  std::string reason;
  ExactValues exact;
  std::optional<Reference> reference;  // where the integral is not known
  double build_s = 0, setup_s = 0;
  std::size_t table_bytes = 0, coefficient_bytes = 0;
  double floor = 0;  // estimated rms error level of rounding, in the unit of the integral
  std::vector<Row> rows;
  RateFit rate;
  RateVerdict verdict;
  CellVerdict stability;
};

// A cell with its program built and warmed up and its tables uploaded, so that nothing is built
// while others are timed.
class PreparedCell {
 public:
  PreparedCell(const Catalog& catalog, Device& device, Device& exact_device, Plan plan);

  // All rows; a row that cannot be finished throws. Called once. `rows_of_run`: rows of all cells
  // of the run, among which the tests share their false-alarm probability; 0: those of this cell.
  // Where the integral is not known, errors are against `reference`, or without one against the
  // cell's own last estimate.
  CellResult run(std::size_t rows_of_run = 0,
                 const std::optional<Reference>& reference = std::nullopt);
  // One row, untimed repeats and all.
  Row run_row(std::uint64_t n);

  const Plan& plan() const { return *plan_; }
  const ExactValues& exact() const { return exact_; }
  Integrator& integrator() { return *integrator_; }
  double build_s() const { return build_s_; }

 private:
  struct Sums;
  double once(std::uint64_t n, Sums& sums);
  void summarise(const Sums& sums, Row& row);
  void take_errors(CellResult& result, const std::optional<Reference>& reference) const;
  void qualify(Row& row, const std::vector<double>& variances) const;
  void estimate_kurtosis_of_f();
  void take_rate(CellResult& result) const;
  CellFacts facts_of(const CellResult& result) const;

  const Catalog& catalog_;
  std::unique_ptr<Plan> plan_;  // the integrator keeps a reference
  ExactValues exact_;
  std::unique_ptr<Integrator> integrator_;
  double build_s_ = 0;
  double y0_ = 0;
  Kurtosis kurtosis_;  // of f, where a normal approximation over its values is used
};

// The level below which errors are rounding, not sampling: E|f| (4 u + sqrt(n) u_sum), u of the
// evaluation and u_sum of the accumulator over n additions per lane; the estimate of
// 5-numerics 2.1, not the bound.
double rounding_floor(const Plan& plan, const ExactValues& exact, std::uint64_t n);

}  // namespace koksma
