#include "report/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <map>

#include "error/error.hpp"
#include "report/compare_context.hpp"
#include "report/compare_errors.hpp"
#include "report/compare_share.hpp"
#include "report/compare_times.hpp"
#include "report/results.hpp"

namespace koksma {
namespace {

// The standard error of a median of n normal variables is sqrt(pi / 2) sd / sqrt(n).
constexpr double kOfMedian = 1.2533141373155;
// So few cells tell their own spread badly: a Student variable of 4 degrees of freedom exceeds 4.4
// as often as a normal one 2.6.
constexpr std::size_t kLeastCells = 40;
constexpr std::size_t kLevels = 3;  // rows, cells, the study: alpha is shared by them

std::string key_of(const Json& cell, const Json& precision) {
  std::string key;
  const Json& scene = cell["scene"];
  for (const char* part : {"integrand", "d", "parameters", "choices"}) key += scene[part].dump();
  for (const char* part : {"sampler", "estimator", "sum"}) key += cell[part].dump();
  return key + precision.dump();
}

// Cells by key; of equal ones, as a study may hold, the first, second, ... are told apart.
std::map<std::string, const Json*> by_key(const Json& cells) {
  std::map<std::string, const Json*> map;
  for (const Json& cell : cells) {
    const std::string key = key_of(cell, cell["precision"]);
    for (std::size_t k = 0; !map.try_emplace(fmt::format("{} {}", key, k), &cell).second;) ++k;
  }
  return map;
}

Json short_context(Json context) {
  context.erase("study");
  return context;
}

// Pairs of cells: of each of the base, that of the new results or nullptr. A cell that failed does
// not know its precision where the study leaves it to the device.
std::map<const Json*, const Json*> paired(const Json& base, const Json& now) {
  const auto others = by_key(now);
  std::map<const Json*, const Json*> partner;
  for (const auto& [key, cell] : by_key(base)) {
    auto found = others.find(key);
    if (found == others.end()) found = others.find(key_of(*cell, nullptr) + " 0");
    partner[cell] = found == others.end() ? nullptr : found->second;
  }
  return partner;
}

// Why a cell with a stop rule, as was asked for, did not go on to n samples; else "".
std::string stopped_before(const Json& cell, std::uint64_t n) {
  const Json& stopped = cell["stopped"];
  if (!stopped.is_object() || n <= stopped["at_n"].get<std::uint64_t>()) return "";
  if (stopped["by"] != "until" && stopped["by"] != "time-budget") return "";
  return fmt::format("not run: {}", stopped["reason"].get<std::string>());
}

// Everything of one comparison; the tests are made once all rows are known, among which the error
// probability is shared.
class Comparer {
 public:
  Comparer(const Json& base, const Json& now, const CompareOptions& options) {
    result_.options = options;
    result_.base = short_context(base["context"]);
    result_.now = short_context(now["context"]);
    result_.notes = context_notes(base["context"], now["context"], options);
    times_wanted_ = options.across_devices || same_device(base["context"], now["context"]);
    same_calibration_ = same_calibration(base["context"], now["context"]);
    const auto partner = paired(base["cells"], now["cells"]);
    for (const Json& cell : base["cells"]) add(cell, partner.at(&cell));
    for (const Json& cell : now["cells"])
      if (std::none_of(partner.begin(), partner.end(),
                       [&](const auto& pair) { return pair.second == &cell; }))
        result_.cells.push_back({cell_name(cell, ' '), CellState::added, cell["reason"], {}, {}});
  }

  Comparison finish() {
    judge_errors();
    judge_times();
    return std::move(result_);
  }

 private:
  struct Pair {
    std::size_t cell, row;  // places in result_
    const Json *base, *now;
    double floor;
    std::string no_times;  // why
    Launches base_launches, new_launches;
    Stratum compared;
    bool calibrated = false;
  };
  using Pairs = std::vector<Pair*>;

  void add(const Json& base, const Json* now) {
    CellChange cell;
    cell.name = cell_name(base, ' ');
    const bool was_ok = base["status"] == "ok";
    if (now == nullptr) {
      cell.state = was_ok ? CellState::vanished : CellState::idle;
      cell.reason = "the cell is not in the new results";
    } else if ((*now)["status"] != "ok") {
      cell.state = was_ok ? CellState::failed : CellState::idle;
      const std::string reason = (*now)["reason"];
      cell.reason = fmt::format("{}: {}", (*now)["status"].get<std::string>(),
                                reason.substr(0, reason.find('\n')));
    } else if (!was_ok) {
      cell.state = CellState::repaired;
    }
    result_.cells.push_back(std::move(cell));
    if (result_.cells.back().state == CellState::compared) add_rows(base, *now);
  }

  void add_rows(const Json& base, const Json& now) {
    CellChange& cell = result_.cells.back();
    for (const Json& row : base["rows"]) {
      RowChange change;
      change.n = row["n"];
      const auto other = std::find_if(now["rows"].begin(), now["rows"].end(),
                                      [&](const Json& r) { return r["n"] == row["n"]; });
      if (other == now["rows"].end()) {
        const std::string stopped = stopped_before(now, change.n);
        if (stopped.empty()) change.vanished = "the row is not in the new results";
        change.time.reason = change.error.reason = stopped.empty() ? change.vanished : stopped;
      } else {
        pairs_.push_back({result_.cells.size() - 1,
                          cell.rows.size(),
                          &row,
                          &*other,
                          common_floor(base, now),
                          no_times(base, now),
                          {},
                          {},
                          {}});
      }
      cell.rows.push_back(std::move(change));
    }
  }

  std::string no_times(const Json& base, const Json& now) const {
    if (!times_wanted_) return "another device";
    if (!same_calibration_ && !result_.options.across_devices) return "another calibration kernel";
    return why_not_timed(base, now);
  }

  RowChange& row_of(const Pair& pair) { return result_.cells[pair.cell].rows[pair.row]; }

  std::vector<double> ratios_of(const Pairs& rows) {
    std::vector<double> ratios;
    for (const Pair* pair : rows) ratios.push_back(row_of(*pair).time.ratio);
    return ratios;
  }

  static std::vector<Stratum> strata_of(const Pairs& rows) {
    std::vector<Stratum> strata;
    for (const Pair* pair : rows) strata.push_back(pair->compared);
    return strata;
  }

  void judge_errors() {
    const auto known =
        static_cast<std::size_t>(std::count_if(pairs_.begin(), pairs_.end(), [](const Pair& pair) {
          return (*pair.base)["rmse"].is_number();
        }));
    result_.rows_with_errors = known;
    if (known == 0) return;
    const double z_limit = quantile(
        complement(boost::math::normal(), result_.options.alpha / static_cast<double>(known)));
    for (const Pair& pair : pairs_)
      row_of(pair).error = error_change(*pair.base, *pair.now, pair.floor, z_limit);
  }

  void take_times(Pair& pair) {
    if (!pair.no_times.empty()) {
      row_of(pair).time.reason = pair.no_times;
      return;
    }
    const bool calibrated = same_calibration_ && same_device(result_.base, result_.now) &&
                            pair.base->contains("calibration_s") &&
                            pair.now->contains("calibration_s");
    pair.base_launches = launches_of(*pair.base, calibrated);
    pair.new_launches = launches_of(*pair.now, calibrated);
    if (pair.base_launches.times.empty() || pair.new_launches.times.empty()) {
      row_of(pair).time.reason = "no times of single launches";
      return;
    }
    // Results of before 2026-11-29 do not tell: every launch was one run, and its start showed.
    const auto runs = [](const Json& row) { return row.value("runs_per_launch", 0); };
    if (std::min(runs(*pair.base), runs(*pair.now)) == 0 &&
        std::max(runs(*pair.base), runs(*pair.now)) > 1) {
      row_of(pair).time.reason = "one run per launch on one side, several on the other";
      return;
    }
    ++result_.rows_timed;
    pair.calibrated = calibrated;
    uncalibrated_ += calibrated ? 0 : 1;
    if (calibrated)
      calibration_.push_back({pair.base_launches.calibrations, pair.new_launches.calibrations});
  }

  void judge_times() {
    for (Pair& pair : pairs_) take_times(pair);
    if (uncalibrated_ > 0)
      result_.notes.push_back(
          fmt::format("{} rows have no calibration on one device: their times are compared as they "
                      "are, drift of the machine and all",
                      uncalibrated_));
    if (result_.rows_timed == 0) {
      result_.study.reason = "no row has times to compare";
      return;
    }
    std::map<std::size_t, Pairs> cells;
    Pairs all;
    for (Pair& pair : pairs_) {
      if (!row_of(pair).time.reason.empty()) continue;
      cells[pair.cell].push_back(&pair);
      all.push_back(&pair);
    }
    if (!calibration_.empty()) result_.calibration_ratio = combined_change(calibration_).ratio;
    judge_rows(all);
    std::vector<double> cell_ratios;
    for (const auto& [place, rows] : cells) {
      TimeChange& time = result_.cells[place].time;
      time = combined_change(strata_of(rows));
      cell_ratios.push_back(time.ratio);
    }
    result_.cells_timed = cells.size();
    result_.study = combined_change(strata_of(all));
    // Cells too few to tell vary no more than their rows; the median over all takes rows for
    // independent then.
    const bool few = cells.size() < kLeastCells;
    result_.cell_spread = few ? result_.row_spread : spread_of(cell_ratios);
    result_.study_spread = kOfMedian * result_.cell_spread /
                           std::sqrt(static_cast<double>(few ? all.size() : cells.size()));
    decide_times();
  }

  // Rows, and how far their ratios lie apart.
  void judge_rows(const Pairs& rows) {
    judge_calibration(rows);
    for (Pair* pair : rows) {
      pair->compared = less_followed(pair->base_launches, pair->new_launches,
                                     result_.calibration_followed.value_or(0));
      row_of(*pair).time = time_change(pair->compared);
    }
    result_.row_spread = spread_of(ratios_of(rows));
  }

  void judge_calibration(const Pairs& rows) {
    std::vector<Launches> base, now;
    for (const Pair* pair : rows) {
      if (!pair->calibrated) continue;
      base.push_back(pair->base_launches);
      now.push_back(pair->new_launches);
    }
    if (base.empty()) return;
    const Followed followed = what_is_followed(base, now);
    result_.calibration_followed = followed.share;
    result_.clock_ratio = std::exp(followed.clock);
    // Less is left to the threshold.
    if (std::fabs(followed.clock) < std::log1p(result_.options.threshold)) return;
    explained_ = followed.explained();
    explained_of_one_ = followed.explained_of_one();
    const auto ratios = [](const Interval& logarithms) {
      return Interval{std::exp(logarithms.low), std::exp(logarithms.high)};
    };
    result_.explained = ratios(explained_);
    result_.explained_of_one = ratios(explained_of_one_);
    result_.notes.push_back(
        fmt::format("the device itself was {:.2f} times as {} as before: run both again to know of "
                    "changes that "
                    "this may explain",
                    std::exp(std::fabs(followed.clock)), followed.clock > 0 ? "slow" : "fast"));
  }

  // A third of alpha to each level, there divided by the number of tests.
  void decide_times() {
    const double threshold = result_.options.threshold, share = result_.options.alpha / kLevels;
    const auto rows = static_cast<double>(result_.rows_timed),
               cells = static_cast<double>(result_.cells_timed);
    const std::size_t ratios =
        result_.cells_timed < kLeastCells ? result_.rows_timed : result_.cells_timed;
    for (CellChange& cell : result_.cells) {
      for (RowChange& row : cell.rows)
        decide(row.time, threshold, share / rows, result_.row_spread,
               single_dof(result_.rows_timed), explained_of_one_);
      decide(cell.time, threshold, share / cells, result_.cell_spread, single_dof(ratios),
             explained_of_one_);
    }
    decide(result_.study, threshold, share, result_.study_spread, spread_dof(ratios),
           result_.cells_timed == 1 ? explained_of_one_ : explained_);
  }

  Comparison result_;
  bool times_wanted_ = true, same_calibration_ = true;
  std::size_t uncalibrated_ = 0;
  std::vector<Pair> pairs_;
  std::vector<Stratum> calibration_;
  Interval explained_, explained_of_one_;  // logarithms of ratios, by the device's own speed
};

}  // namespace

bool CellChange::regression() const {
  return state == CellState::vanished || state == CellState::failed ||
         time.change == Change::worse ||
         std::any_of(rows.begin(), rows.end(), [](const RowChange& row) {
           return row.time.change == Change::worse || row.error.change == Change::worse ||
                  !row.vanished.empty();
         });
}

bool Comparison::undecided() const {
  const auto is = [](const TimeChange& time) { return time.change == Change::undecided; };
  return is(study) || std::any_of(cells.begin(), cells.end(), [&](const CellChange& cell) {
           return is(cell.time) || std::any_of(cell.rows.begin(), cell.rows.end(),
                                               [&](const RowChange& row) { return is(row.time); });
         });
}

bool Comparison::regression() const {
  return study.change == Change::worse ||
         std::any_of(cells.begin(), cells.end(),
                     [](const CellChange& cell) { return cell.regression(); });
}

Json read_results(const std::string& path) {
  Json json = parse_json(read_text_file(path), path);
  const auto refuse = [&](const std::string& found) {
    throw InputError(path, found, "give a file that `koksma run` wrote");
  };
  if (!json.is_object() || !json.contains("schema_version") || !json.contains("cells"))
    refuse("this is no results file");
  if (json["schema_version"] != kResultsSchemaVersion)
    throw InputError(path,
                     fmt::format("results of schema_version {}", json["schema_version"].dump()),
                     fmt::format("this koksma reads schema_version {}: run the study again with it",
                                 kResultsSchemaVersion));
  check_schema(json, "results/results.schema.json", path);
  return json;
}

Comparison compare_results(const Json& base, const Json& now, const CompareOptions& options) {
  return Comparer(base, now, options).finish();
}

}  // namespace koksma
