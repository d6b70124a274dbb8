// What changed between two results files, beyond noise. Cells are paired by integrand, dimension,
// parameters, choices, sampler, estimator, precision and sum, rows by N.
//
// Times: every launch counts beside the calibration kernel (kernels/calibrate.cl), so that a slow
// hour of a shared machine cancels: of the logarithm of its time what does not follow that of the
// calibration's (report/compare_times.hpp). Samples are compared by
// ranks (report/rank_test.hpp), the change is the Hodges-Lehmann estimate of the ratio. A row is
// slower where that is above the threshold and its Mann-Whitney test rejects; a cell, by the median
// ratio of its rows and van Elteren's test over them; the study, in the same way over all its rows.
// The three share the family-wise error alpha equally, and cells and rows divide theirs by their
// number (Bonferroni). Rank tests
// take launches for independent, but those of one second share what disturbs them; so a change must
// also lie beyond what is likely, at the same levels, by the spread of the ratios between rows,
// between cells, and of the median over cells, with Student's quantiles, as a spread seen in few
// ratios is not known well and single rows and cells are disturbed more than a normal variable
// would be (report/compare_times.hpp). What a whole run has in common is what the
// threshold is for.
//
// The calibration does not tell what times do where the device itself changes (its clock, another
// process throughout a run): what that may explain is undecided, and no regression.
//
// Errors: a row is worse where the confidence intervals of the two RMSE do not overlap and the
// difference of their logarithms is beyond alpha divided by the rows, taking the intervals for
// normal ones of 95 % on that scale. The error of a deterministic point set has no interval: it is
// worse where it grew by more than the rounding floor of either file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "catalog/json.hpp"
#include "estimate/interval.hpp"

namespace koksma {

struct CompareOptions {
  double threshold = 0.15;      // relative change of time below which nothing is reported
  double alpha = 0.01;          // family-wise error of times, and of errors
  bool across_devices = false;  // compare times of different devices
};

// Undecided: beyond what is noise, but a change of the device's own speed may explain it.
enum class Change { none, better, worse, undecided, unknown };

struct TimeChange {
  Change change = Change::unknown;
  double ratio = 0;    // new / base; 0 unknown
  double p = 1;        // one-sided, of the direction of the ratio
  std::string reason;  // why it is unknown
};

struct ErrorChange {
  Change change = Change::unknown;
  std::optional<double> base, now;  // RMSE
  bool suspect = false;  // intervals do not overlap, but that may be chance among so many rows
  std::string reason;    // why it is unknown, or what decided
};

struct RowChange {
  std::uint64_t n = 0;
  TimeChange time;
  ErrorChange error;
  std::string vanished;  // why the row is a regression by itself, else empty
};

enum class CellState { compared, vanished, failed, repaired, added, idle };

struct CellChange {
  std::string name;  // scene, sampler, estimator, precision, sum
  CellState state = CellState::compared;
  std::string reason;
  std::vector<RowChange> rows;
  TimeChange time;

  bool regression() const;
};

struct Comparison {
  CompareOptions options;
  Json base, now;                  // the contexts, less the study
  std::vector<std::string> notes;  // what else differs: device, driver, seed, ...
  std::vector<CellChange> cells;   // those of the base, then new ones
  TimeChange study;
  // How far the ratios of rows and of cells that did not change lie apart, and the median over
  // cells from its mean, as standard deviations of their logarithms; 0: too few to tell.
  double row_spread = 0, cell_spread = 0, study_spread = 0;
  double calibration_ratio = 0;  // of the calibration kernel itself, new / base; 0 unknown
  std::size_t rows_timed = 0, cells_timed = 0, rows_with_errors = 0;
  // The share of the calibration's change, in logarithms, that is taken out of those of times;
  // none: no row is calibrated. How much slower the device itself became, and ratios that this
  // explains, of the study and of one row or cell (report/compare_share.hpp).
  std::optional<double> calibration_followed;
  double clock_ratio = 1;
  Interval explained{1, 1}, explained_of_one{1, 1};

  bool regression() const;
  bool undecided() const;  // a row, a cell or the study is
};

// A results file, checked against the schema. InputError: it cannot be read, is cut off, is of
// another schema_version or no results file at all.
Json read_results(const std::string& path);

// Compares results that read_results has checked.
Comparison compare_results(const Json& base, const Json& now, const CompareOptions& options);

}  // namespace koksma
