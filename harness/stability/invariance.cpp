#include "stability/invariance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include "device/integrator.hpp"
#include "estimate/exact_sum.hpp"
#include "stability/specimens.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Precision kPrecision = Precision::fp32;
const Terms kUniform{"U(0,1)", 0, 1, 0};

// The widest and the narrowest items with two work-group sizes each: a size is part of the program,
// so all pairs would be many.
std::vector<LaunchShape> item_shapes(const DeviceFacts& device) {
  std::vector<LaunchShape> shapes;
  const std::pair<std::uint32_t, std::uint32_t> pairs[] = {{16, 1}, {16, 4}, {8, 1},
                                                           {4, 16}, {1, 1},  {1, 64}};
  for (const auto& [lanes, local] : pairs) {
    const auto most =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(local, device.max_work_group_size));
    shapes.push_back({lanes, most, std::nullopt, std::nullopt});
  }
  return shapes;
}

const std::vector<std::optional<std::uint64_t>> kItemsPerLaunch{std::nullopt, 64, 5};

// The sums of all shapes, by block length.
using Results = std::map<std::uint32_t, std::vector<double>>;

Results results_of(const Catalog& catalog, Device& device, const SumAlgorithm& sum,
                   const InvarianceOptions& options) {
  Results results;
  for (const LaunchShape& items : item_shapes(device.facts())) {
    PlanOptions plan_options;
    plan_options.shape = items;
    Cell cell = terms_cell(catalog, sum.name, kPrecision, options.n);
    cell.scene.parameters = kUniform.parameters();
    Plan plan = make_plan(catalog, cell, device.facts(), "", plan_options);
    Integrator integrator(device, plan, {});
    for (const std::uint32_t block : options.log2_blocks) {
      for (const auto& per_launch : kItemsPerLaunch) {
        plan.shape.log2_block = block;
        plan.shape.items_per_launch = per_launch;
        ExactSum total;
        integrator.run(options.n, 0.0,
                       [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
                         total.add(partials, plan.word_exponent(word));
                       });
        results[block].push_back(total.rounded());
      }
    }
  }
  return results;
}

InvarianceRow summarise(const SumAlgorithm& sum, const Results& results) {
  InvarianceRow row{sum.name, sum.order_free, 0, 0, 0, true};
  std::set<std::uint64_t> all;  // bits: of NaNs, too, and of zeros of either sign
  double least = INFINITY, most = -INFINITY;
  for (const auto& [block, values] : results) {
    std::set<std::uint64_t> distinct;
    for (const double value : values) {
      distinct.insert(std::bit_cast<std::uint64_t>(value));
      least = std::min(least, value);
      most = std::max(most, value);
      row.finite = row.finite && std::isfinite(value);
    }
    row.most_of_one_block = std::max(row.most_of_one_block, distinct.size());
    all.insert(distinct.begin(), distinct.end());
  }
  row.distinct = all.size();
  row.spread = (most - least) / std::max(std::fabs(most), std::fabs(least));
  return row;
}

}  // namespace

Invariance measure_invariance(const Catalog& with_terms, Device& device,
                              const InvarianceOptions& options) {
  const auto start = Clock::now();
  Invariance result;
  result.n = options.n;
  result.shapes =
      item_shapes(device.facts()).size() * kItemsPerLaunch.size() * options.log2_blocks.size();
  for (const SumAlgorithm& sum : with_terms.sums) {
    const auto& asked = options.sums;
    if (!asked.empty() && std::find(asked.begin(), asked.end(), sum.name) == asked.end()) continue;
    if (sum.needs_fp64 && !device.facts().fp64) continue;
    const InvarianceRow row = summarise(sum, results_of(with_terms, device, sum, options));
    if (result.why.empty() && !row.finite)
      result.why = fmt::format("sum '{}' is not finite", row.sum);
    if (result.why.empty() && row.most_of_one_block > 1)
      result.why =
          fmt::format("sum '{}': {} results for one block length", row.sum, row.most_of_one_block);
    if (result.why.empty() && row.order_free && row.distinct > 1)
      result.why =
          fmt::format("sum '{}' is order-free and gives {} results", row.sum, row.distinct);
    result.rows.push_back(row);
  }
  result.ok = result.why.empty();
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace koksma
