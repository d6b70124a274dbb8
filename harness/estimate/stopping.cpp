#include "estimate/stopping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimate/timed_launches.hpp"

namespace koksma {
namespace {

std::optional<double> relative(const std::optional<double>& error, double truth) {
  if (!error || !std::isfinite(truth)) return std::nullopt;
  return truth != 0 ? *error / std::fabs(truth) : *error;
}

std::string why_no_more(const StopFacts& facts) {
  if (!facts.rule.any()) return "the largest N that was asked for";
  if (facts.sampler_ends) return "the sampler has no larger N";
  const std::string open =
      facts.rule.until ? fmt::format("{:.3g} is not reached", *facts.rule.until) : "";
  return fmt::format("the largest N that the cell may go to{}{}", open.empty() ? "" : "; ", open);
}

// The end of the rows, at the last of them.
Stopped stop_at(const StopFacts& facts, std::string by, std::string reason) {
  Stopped stopped;
  stopped.by = std::move(by);
  stopped.reason = std::move(reason);
  stopped.at_n = facts.n;
  stopped.next_n = facts.next;
  stopped.spent_s = facts.spent;
  stopped.reached = facts.reached;
  return stopped;
}

}  // namespace

double row_seconds(double launch, std::size_t most) {
  std::size_t count = 1;
  while (!enough_launches(count, static_cast<double>(count) * launch, most)) ++count;
  // The shortest rows have launches of several runs beside those that are waited for, and as many
  // again to find out how many runs. `launch` is a wall time, of which the kernel's is a part.
  const bool repeats = most >= kMergedRuns && launch < 2 * kSecondsOfRuns;
  const double repeated = repeats ? 2 * kLaunchesAlone * kSecondsOfRuns : 0;
  return static_cast<double>(count) * launch + repeated;
}

std::optional<double> reached_error(const Row& row, const std::optional<double>& mean,
                                    const std::optional<Reference>& reference) {
  if (!row.unresolved.empty()) return std::nullopt;
  if (mean) return relative(row.errors.rmse, *mean);
  if (!reference) {
    if (!row.errors.mean) return std::nullopt;
    return relative(row.errors.sd, *row.errors.mean);
  }
  const std::optional<double> rmse = summarise_errors(row.estimates, reference->value).rmse;
  if (rmse && *rmse < kFloorFactor * reference->error.value_or(0)) return std::nullopt;
  return relative(rmse, reference->value);
}

std::optional<Stopped> why_stop(const StopFacts& facts) {
  const StopRule& rule = facts.rule;
  if (rule.until && facts.reached && *facts.reached <= *rule.until)
    return stop_at(facts, "until",
                   fmt::format("relative RMSE {:.3g} <= {:.3g}", *facts.reached, *rule.until));
  if (!facts.next)
    return stop_at(facts,
                   !rule.any()          ? "study"
                   : facts.sampler_ends ? "sampler"
                                        : "beyond-n",
                   why_no_more(facts));
  const std::optional<TimeLine> line = fit_times(facts.launches);
  if (!rule.time_budget || !line) return std::nullopt;
  const double predicted =
      row_seconds(seconds_at(*line, static_cast<double>(*facts.next)), facts.most_launches);
  if (facts.spent + predicted <= *rule.time_budget) return std::nullopt;
  Stopped stopped = stop_at(
      facts, "time-budget",
      fmt::format("{:.3g} s spent; N = {} is predicted to take {:.3g} s more, of {:.3g} s in all",
                  facts.spent, *facts.next, predicted, *rule.time_budget));
  stopped.predicted_s = predicted;
  return stopped;
}

Stopped stopped_by_sampler(const StopFacts& facts, const std::string& refusal) {
  return stop_at(facts, "sampler", refusal);
}

}  // namespace koksma
