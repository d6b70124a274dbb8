#include "stability/invariance.hpp"

#include <fmt/format.h>

#include <algorithm>
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

// Widths with a work-group size each: a size is part of the program, so all pairs would be many.
std::vector<LaunchShape> item_shapes(const DeviceFacts& device) {
  std::vector<LaunchShape> shapes;
  const std::pair<std::uint32_t, std::uint32_t> pairs[] = {{16, 1}, {8, 1}, {4, 16}, {1, 64}};
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
  InvarianceRow row{sum.name, sum.order_free, 0, 0, 0};
  std::set<double> all;
  for (const auto& [block, values] : results) {
    const std::set<double> distinct(values.begin(), values.end());
    row.most_of_one_block = std::max(row.most_of_one_block, distinct.size());
    all.insert(distinct.begin(), distinct.end());
  }
  row.distinct = all.size();
  row.spread = (*all.rbegin() - *all.begin()) / std::fabs(*all.rbegin());
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
