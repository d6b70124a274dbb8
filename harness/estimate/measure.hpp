// Runs one prepared cell: partial sums -> exact merge -> replicates -> statistics, with times
// beside every error.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/calibration.hpp"
#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "estimate/assess.hpp"
#include "estimate/cell_result.hpp"
#include "estimate/kurtosis.hpp"
#include "estimate/timed_launches.hpp"

namespace koksma {

// A cell with its program built and warmed up and its tables uploaded, so that nothing is built
// while others are timed.
class PreparedCell {
 public:
  PreparedCell(const Catalog& catalog, Device& device, Device& exact_device, Plan plan);

  // All rows, as far as the cell's stop rule goes; a row that cannot be finished throws. Called
  // once. `rows_of_run`: rows of all cells of the run, among which the tests share their
  // false-alarm probability; 0: those of this cell. Where the integral is not known, errors are
  // against `reference`, or without one against the cell's own last estimate.
  CellResult run(std::size_t rows_of_run = 0,
                 const std::optional<Reference>& reference = std::nullopt);
  // The same in steps, between which other cells may be timed: start, then time_again while it is
  // unfinished, each with the same reference.
  void start(const std::optional<Reference>& reference = std::nullopt);
  bool unfinished() const { return pass_ < kPasses; }
  void time_again();
  // Once started, of the launches so far. Estimates and errors are final.
  CellResult result(std::size_t rows_of_run = 0,
                    const std::optional<Reference>& reference = std::nullopt) const;
  // One row by itself, timed in a few launches beside the calibration kernel.
  Row run_row(std::uint64_t n);

  const Plan& plan() const { return *plan_; }
  const ExactValues& exact() const { return exact_; }
  Integrator& integrator() { return *integrator_; }
  double build_s() const { return build_s_; }
  const Calibration& calibration() const { return *calibration_; }
  // For judging its rows again, once more is known of them.
  CellContext context() const;

 private:
  struct Sums;
  class Together;
  Stopped run_rows(const std::optional<Reference>& reference);
  // Tables to n, beyond the plan's sizes; else the reason why the sampler can not.
  std::string extend(std::uint64_t n);
  void start_integrator();
  double once(std::uint64_t n, Sums& sums);
  // The first launch of a row, and what it gives; its times go to timed.
  Row first_launch(std::uint64_t n, TimedLaunches& timed);
  // Further rounds over these rows, one launch of each after the other, until they have this share
  // of their launches. The first five runs of a row are waited for and merged one by one, as
  // row.wall counts them. Those of rows short enough make several runs each from then on.
  void time_rounds(std::vector<Row>& rows, std::size_t first, std::size_t most_rounds, double share,
                   TimedLaunches& timed);
  void choose_runs(Row& row, TimedLaunches& timed);
  void summarise(const Sums& sums, Row& row);
  void estimate_kurtosis_of_f();

  const Catalog& catalog_;
  Device& device_;
  std::unique_ptr<Plan> plan_;  // the integrator keeps a reference
  ExactValues exact_;
  std::unique_ptr<Integrator> integrator_;
  std::unique_ptr<Calibration> calibration_;
  double build_s_ = 0;
  double earlier_setup_s_ = 0;  // of integrators with smaller tables
  double y0_ = 0;
  Kurtosis kurtosis_;  // of f, where a normal approximation over its values is used

  std::vector<Row> rows_;
  std::optional<Stopped> stopped_;        // once started
  std::unique_ptr<TimedLaunches> timed_;  // the same
  std::size_t pass_ = 0;                  // that were made, of kPasses
};

}  // namespace koksma
