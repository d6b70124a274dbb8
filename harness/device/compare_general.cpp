#include "device/compare_general.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "device/fastest.hpp"
#include "device/integrator.hpp"
#include "plan/general.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

// Sums of y and of what is squared, of the last run.
struct Sums {
  double values = 0, squares = 0;
};

// About 0: only the scale of f is wanted.
double run(Integrator& integrator, const Plan& plan, std::uint64_t n, Sums& sums) {
  sums = {};
  return integrator.run(n, 0.0,
                        [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
                          double sum = 0;
                          for (const double partial : partials) sum += partial;
                          sum = std::ldexp(sum, plan.word_exponent(word));
                          if (word < plan.sum_words()) sums.values += sum;
                          if (word >= plan.sum_words() && word < 2 * plan.sum_words())
                            sums.squares += sum;
                        });
}

// Two evaluations of f at the same point differ by its declared error each, and partial sums by
// their rounding, relative to the root mean square of f.
double allowed_difference(const Plan& plan, double mean_square, std::uint64_t block) {
  const double unit = plan.fp64() ? 0x1p-53 : 0x1p-24;
  const double ulps = plan.fp64() ? plan.integrand->ulps_fp64 : plan.integrand->ulps_fp32;
  double terms = 0;
  const double sum_unit = plan.stores_doubles() ? 0x1p-53 : 0x1p-24;
  for (const RoundingTerm& term : plan.sum->bound)
    terms += term.factor * std::pow(static_cast<double>(block), term.power_of_n) *
             std::pow(sum_unit, term.power_of_u);
  return 2 * (2 * ulps * unit + terms + plan.sum->quantum) * std::sqrt(mean_square);
}

void check_agreement(const GeneralComparison& result) {
  const bool both_nan = std::isnan(result.planned) && std::isnan(result.general);
  const bool same = result.planned == result.general || both_nan;  // infinities too
  if (same || std::fabs(result.planned - result.general) <= result.allowed) return;
  throw std::runtime_error(fmt::format(
      "the planned kernel's estimate {:.17g} and the general one's {:.17g} differ by {:.3g}, "
      "{:.3g} "
      "is rounding: one of them is wrong",
      result.planned, result.general, std::fabs(result.planned - result.general), result.allowed));
}

}  // namespace

GeneralComparison compare_with_general(Device& device, const Catalog& catalog, const Plan& plan,
                                       const std::vector<double>& coefficients, std::uint64_t n,
                                       const Rounds& rounds) {
  GeneralPlan general = general_plan(catalog, plan);
  // A set of one N has a table of its own.
  if (!plan.sampler->extensible) general.plan.request.end_index = n;
  const std::vector<std::byte> table = general_table(general);
  Integrator planned(device, plan, coefficients), twin(device, general.plan, coefficients, table);
  planned.prepare(n);
  GeneralComparison result;
  Sums planned_sums, general_sums;
  // The first launch of a kernel specialises it on some implementations.
  run(planned, plan, n, planned_sums);
  run(twin, general.plan, n, general_sums);

  const auto start = Clock::now();
  Fastest planned_s, general_s;
  for (; result.rounds < rounds.most; ++result.rounds) {
    result.settled = planned_s.settled() && general_s.settled();
    const double spent = std::chrono::duration<double>(Clock::now() - start).count();
    if (result.rounds >= rounds.least && spent >= rounds.least_seconds &&
        (result.settled || spent > rounds.seconds))
      break;
    planned_s.add(run(planned, plan, n, planned_sums));
    general_s.add(run(twin, general.plan, n, general_sums));
  }
  const double samples = static_cast<double>(n) * plan.launched_replicates();
  result.planned_s = planned_s.best();
  result.general_s = general_s.best();
  result.planned = planned_sums.values / samples;
  result.general = general_sums.values / samples;
  const std::uint64_t block = std::uint64_t{1} << planned.log2_block(n);
  result.allowed = allowed_difference(plan, general_sums.squares / samples, block);
  result.planned_table = planned.table_bytes();
  result.general_table = table.size();
  check_agreement(result);
  return result;
}

}  // namespace koksma
