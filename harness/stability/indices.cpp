#include "stability/indices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>

#include "device/integrator.hpp"
#include "stability/specimens.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;
__extension__ using Wide = unsigned __int128;

// Sums of i and i^2 for i < n, modulo 2^64: the factors 2 and 3 are taken out where they divide.
std::uint64_t sum_below(std::uint64_t n) {
  if (n == 0) return 0;
  return static_cast<std::uint64_t>(static_cast<Wide>(n) * (n - 1) / 2);
}
std::uint64_t squares_below(std::uint64_t n) {
  if (n == 0) return 0;
  Wide half = static_cast<Wide>(n) * (n - 1) / 2;
  Wide odd = 2 * static_cast<Wide>(n) - 1;
  (half % 3 == 0 ? half : odd) /= 3;
  return static_cast<std::uint64_t>(half) * static_cast<std::uint64_t>(odd);
}

struct Range {
  std::uint64_t first_block, end;
  std::uint32_t log2_block;
};

// From a few blocks below each power of two to an odd end above it, and all indices from 0 in
// blocks of the usual and the longest length.
std::vector<Range> ranges() {
  std::vector<Range> result{
      {0, (1U << 20) + 37, 14}, {0, (1U << 20) + 37, 21}, {0, 1, 8}, {0, 4097, 4}};
  for (const unsigned log2_offset : {31U, 32U, 63U})
    for (const std::uint32_t log2_block : {8U, 12U}) {
      const std::uint64_t power = std::uint64_t{1} << log2_offset;
      result.push_back({(power >> log2_block) - 3, power + (5U << log2_block) + 11, log2_block});
    }
  return result;
}

void run_check(Integrator& integrator, IndexRangeCheck& check) {
  IndexSums sums;
  std::uint64_t* const words[] = {&sums.count, &sums.total, &sums.squares, &sums.mixed};
  const std::uint64_t length = std::uint64_t{1} << check.log2_block;
  integrator.run_blocks(check.end, check.log2_block, check.first >> check.log2_block,
                        (check.end + length - 1) >> check.log2_block, 1, 0.0,
                        [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
                          for (const double& partial : partials) {
                            const auto bits = std::bit_cast<std::uint64_t>(partial);
                            if (word == 3)
                              sums.mixed ^= bits;
                            else
                              *words[word] += bits;
                          }
                        });
  const IndexSums expected = host_index_sums(check.first, check.end);
  check.count_ok = sums.count == expected.count;
  check.sum_ok = sums.total == expected.total;
  check.squares_ok = sums.squares == expected.squares;
  check.xor_ok = sums.mixed == expected.mixed;
}

}  // namespace

bool IndexChecks::sums_ok() const {
  return std::all_of(checks.begin(), checks.end(),
                     [](const IndexRangeCheck& check) { return check.count_ok && check.sum_ok; });
}
bool IndexChecks::squares_ok() const {
  return std::all_of(checks.begin(), checks.end(),
                     [](const IndexRangeCheck& check) { return check.squares_ok; });
}
bool IndexChecks::xors_ok() const {
  return std::all_of(checks.begin(), checks.end(),
                     [](const IndexRangeCheck& check) { return check.xor_ok; });
}

IndexSums host_index_sums(std::uint64_t first, std::uint64_t end) {
  IndexSums sums{end - first, sum_below(end) - sum_below(first),
                 squares_below(end) - squares_below(first), 0};
  for (std::uint64_t i = first; i < end; ++i) sums.mixed ^= index_mix(i);
  return sums;
}

IndexChecks check_indices(const Catalog& with_indices, Device& device) {
  const auto start = Clock::now();
  IndexChecks result;
  if (!device.facts().fp64) {
    result.ok = true;
    result.why = "not checked: an index takes a word of 64 bits, and the device lacks fp64";
    return result;
  }
  for (const LaunchShape& shape : {LaunchShape{16, 1, {}, {}}, LaunchShape{4, 16, {}, {}}}) {
    PlanOptions options;
    options.shape = shape;
    Plan plan = make_plan(with_indices, index_cell(with_indices, 1), device.facts(), "", options);
    Integrator integrator(device, plan, {});
    for (const Range& range : ranges()) {
      for (const std::optional<std::uint64_t> items : {std::optional<std::uint64_t>(), {1}, {3}}) {
        plan.shape.items_per_launch = items;
        IndexRangeCheck check;
        check.first = range.first_block << range.log2_block;
        check.end = range.end;
        check.lanes_per_item = shape.lanes_per_item;
        check.log2_block = range.log2_block;
        check.items_per_launch = items;
        run_check(integrator, check);
        if (!check.ok() && result.why.empty())
          result.why = fmt::format(
              "indices {} to {}, blocks of 2^{}, {} lanes per item, {} items per launch: count {}, "
              "sum {}, squares {}, XOR {}",
              check.first, check.end - 1, check.log2_block, check.lanes_per_item,
              items ? fmt::format("{}", *items) : "all", check.count_ok, check.sum_ok,
              check.squares_ok, check.xor_ok);
        result.checks.push_back(check);
      }
    }
  }
  result.ok = result.why.empty();
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace koksma
