#include "estimate/convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "estimate/curve.hpp"
#include "estimate/statistics.hpp"

namespace koksma {

namespace {

// Page 5, sections 2.9 and 3.
constexpr std::uint64_t kFewestSamples = 256;
constexpr std::size_t kFewestRows = 6;
// A resample with an RMSE of 0 has no slope; an interval from fewer resamples than this share is
// not believed.
constexpr double kFewestValidResamples = 0.95;

// The count of replicates that most rows have; the larger one of equally frequent counts.
std::size_t common_replicates(std::span<const ConvergenceRow> rows) {
  std::map<std::size_t, std::size_t> frequency;
  for (const ConvergenceRow& row : rows) {
    if (!row.errors.empty()) ++frequency[row.errors.size()];
  }
  std::size_t best = 0;
  for (const auto& [count, times] : frequency) {
    if (best == 0 || times >= frequency[best]) best = count;
  }
  return best;
}

bool unresolved(const ConvergenceRow& row) {
  return !row.unresolved.empty() || (row.n_eff && !(*row.n_eff >= kFewestEffective));
}

std::string why_excluded(const ConvergenceRow& row, std::size_t replicates,
                         const FitOptions& options) {
  if (!std::has_single_bit(row.samples)) return "N is not a power of two";
  if (row.samples < kFewestSamples) return "N < 2^8";
  if (row.errors.empty()) return "no replicates";
  if (row.errors.size() != replicates) return "another number of replicates";
  for (const double e : row.errors) {
    if (!std::isfinite(e)) return "a replicate is not finite";
  }
  const double rmse = root_mean_square(row.errors);
  if (!(rmse > 0)) return "RMSE = 0";
  // Written so that a NaN excludes.
  if (!(rmse >= kFloorFactor * row.floor)) return "below the floor: RMSE < 3 F";
  if (options.infinite_variance)
    return row.unresolved.empty() ? "" : fmt::format("{}{}", kUnresolved, row.unresolved);
  if (row.mean_abs && !(rmse <= *row.mean_abs / 2))
    return fmt::format("{}RMSE > E|f|/2", kUnresolved);
  if (row.n_eff && !(*row.n_eff >= kFewestEffective))
    return fmt::format("{}n_eff < 30", kUnresolved);
  return row.unresolved.empty() ? "" : fmt::format("{}{}", kUnresolved, row.unresolved);
}

std::vector<const ConvergenceRow*> by_samples(std::span<const ConvergenceRow> rows) {
  std::vector<const ConvergenceRow*> sorted;
  for (const ConvergenceRow& row : rows) sorted.push_back(&row);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto* a, const auto* b) { return a->samples < b->samples; });
  return sorted;
}

// All rows that have errors of this many replicates, at any level and any N. An unresolved row is
// flat because nothing of f has been hit yet, which is no plateau of the points.
Plateau decide_plateau(std::span<const ConvergenceRow> rows, const FitOptions& options,
                       std::size_t replicates) {
  Plateau none;
  none.reason = "infinite variance: the RMSE has no level";
  if (options.infinite_variance) return none;
  std::vector<const ConvergenceRow*> eligible;
  for (const ConvergenceRow* row : by_samples(rows)) {
    const bool finite = std::all_of(row->errors.begin(), row->errors.end(),
                                    [](double e) { return std::isfinite(e); });
    const bool repeated = !eligible.empty() && eligible.back()->samples == row->samples;
    if (replicates > 0 && row->errors.size() == replicates && finite && !repeated &&
        !unresolved(*row))
      eligible.push_back(row);
  }
  return find_plateau(eligible);
}

// Takes the rows of a plateau out of the used ones. A curve that is structurally flat as a whole
// keeps its rate, which is 0: it is that of its points.
void exclude_plateau(std::vector<const ConvergenceRow*>& used, RateFit& fit) {
  fit.bend = find_break(used);
  if (fit.plateau.kind == PlateauKind::none || used.empty()) return;
  // The bend of a curve may also be one of its beginning.
  const bool bends_flat = fit.bend && fit.bend->slope_after > -kFlatSlope;
  const double from =
      bends_flat ? fit.bend->log2_samples : std::log2(static_cast<double>(fit.plateau.from));
  const auto first = std::find_if(used.begin(), used.end(), [from](const auto* row) {
    return std::log2(static_cast<double>(row->samples)) >= from;
  });
  if (first == used.end()) return;
  if (first == used.begin() && fit.plateau.kind == PlateauKind::structural) return;
  const std::string reason =
      fmt::format("plateau from N = 2^{}", std::countr_zero((*first)->samples));
  for (auto row = first; row != used.end(); ++row)
    fit.excluded.push_back({(*row)->samples, reason});
  used.erase(first, used.end());
  fit.used.resize(used.size());
}

// Splits the rows into used ones, by ascending N, and excluded ones.
std::vector<const ConvergenceRow*> select_rows(std::span<const ConvergenceRow> rows,
                                               const FitOptions& options, RateFit& fit) {
  std::vector<const ConvergenceRow*> used;
  for (const ConvergenceRow* row : by_samples(rows)) {
    std::string reason = why_excluded(*row, fit.replicates, options);
    if (reason.empty() && !used.empty() && used.back()->samples == row->samples) {
      reason = "N repeated";
    }
    if (reason.empty()) {
      used.push_back(row);
      fit.used.push_back(row->samples);
    } else {
      fit.excluded.push_back({row->samples, reason});
    }
  }
  return used;
}

bool has_heavy_tail(const ConvergenceRow& row) {
  return row.errors.size() >= kFewestForTails &&
         root_mean_square(row.errors) > kHeavyTailRatio * median_abs(row.errors);
}

std::vector<LocalSlope> local_slopes(const std::vector<const ConvergenceRow*>& used, bool median) {
  std::vector<LocalSlope> slopes;
  for (std::size_t m = 1; m < used.size(); ++m) {
    const ConvergenceRow& from = *used[m - 1];
    const ConvergenceRow& to = *used[m];
    const double before = median ? median_abs(from.errors) : root_mean_square(from.errors);
    const double after = median ? median_abs(to.errors) : root_mean_square(to.errors);
    const double octaves =
        std::log2(static_cast<double>(to.samples)) - std::log2(static_cast<double>(from.samples));
    const double slope = (std::log2(after) - std::log2(before)) / octaves;
    if (std::isfinite(slope)) slopes.push_back({from.samples, to.samples, slope});
  }
  return slopes;
}

using SlopeOf = std::optional<double> (*)(const Curve&, std::span<const std::uint32_t>);

std::optional<Interval> bootstrap_slope(const Curve& curve, SlopeOf slope_of,
                                        const FitOptions& options) {
  SplitMix64 generator(options.seed);
  std::vector<std::uint32_t> counts(curve.replicates);
  std::vector<double> slopes;
  for (std::size_t b = 0; b < options.resamples; ++b) {
    draw_counts(generator, counts);
    if (const std::optional<double> slope = slope_of(curve, counts)) slopes.push_back(*slope);
  }
  const double enough = kFewestValidResamples * static_cast<double>(options.resamples);
  if (static_cast<double>(slopes.size()) < enough) return std::nullopt;
  return percentile_interval(slopes);
}

// Slopes and intervals, once there are enough rows.
void fit_curve(const std::vector<const ConvergenceRow*>& used, const FitOptions& options,
               RateFit& fit) {
  const Curve curve = make_curve(used);
  const std::vector<std::uint32_t> once(curve.replicates, 1);
  if (options.infinite_variance) {
    fit.reason = "infinite variance: only the median is fitted";
  } else {
    if (const std::optional<Line> line = rmse_line(curve, once)) {
      fit.slope = line->slope;
      fit.intercept = line->intercept;
    }
  }
  if (fit.heavy_tailed || options.infinite_variance) fit.median_slope = median_slope(curve, once);
  if (fit.deterministic) {
    fit.reason += fit.reason.empty() ? "" : "; ";
    fit.reason += "deterministic: no interval";
    return;
  }
  if (curve.replicates < kFewestForInterval) {
    fit.reason += fit.reason.empty() ? "" : "; ";
    fit.reason += "fewer than 8 replicates: no interval";
    return;
  }
  if (fit.slope) {
    fit.interval = bootstrap_slope(curve, rmse_slope, options);
    if (!fit.interval) fit.reason = "too few resamples have a slope";
  }
  if (fit.median_slope) fit.median_interval = bootstrap_slope(curve, median_slope, options);
}

}  // namespace

RateFit fit_rate(std::span<const ConvergenceRow> rows, const FitOptions& options) {
  RateFit fit;
  fit.replicates = common_replicates(rows);
  fit.deterministic = fit.replicates == 1;
  fit.plateau = decide_plateau(rows, options, fit.replicates);
  std::vector<const ConvergenceRow*> used = select_rows(rows, options, fit);
  exclude_plateau(used, fit);
  fit.local_slopes = local_slopes(used, options.infinite_variance);
  const auto heavy =
      std::count_if(used.begin(), used.end(), [](const auto* row) { return has_heavy_tail(*row); });
  fit.heavy_tailed = heavy >= 2 && static_cast<std::size_t>(heavy) * 4 >= used.size();
  if (used.size() < kFewestRows) {
    fit.reason = "fewer than 6 usable rows";
    return fit;
  }
  fit_curve(used, options, fit);
  return fit;
}

}  // namespace koksma
