#include "plan/general.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "catalog/embedded.hpp"
#include "error/error.hpp"
#include "plan/compose.hpp"

namespace koksma {
namespace {

// The switches in the order of their words; those of the family's own defines follow. An even
// number, as some tables hold 64-bit words in fp32 too.
constexpr std::uint32_t kSwitchWords = 16;
constexpr std::uint32_t kDim = 0, kSquaresOf = 1, kCounts = 2, kCentred = 3, kFamily = 4;

// A general kernel is not written for the dimension at hand: room for this many, or twice as many
// as often as needed.
constexpr std::uint32_t kLeastStates = 64;

std::uint32_t interlaced(const Plan& plan) {
  return plan.request.dim * plan.request.options.value("interlace", 1U);
}

std::uint64_t squares_of(const std::string& second_moment) {
  return second_moment == "pair-means" ? 1 : second_moment == "pair-differences" ? 2 : 0;
}

std::vector<std::uint64_t> switches(const Plan& plan) {
  std::vector<std::uint64_t> words(kSwitchWords, 0);
  words[kDim] = plan.request.dim;
  words[kSquaresOf] = squares_of(plan.estimator->second_moment);
  words[kCounts] = plan.counters ? 1 : 0;
  words[kCentred] = plan.sampler->centred ? 1 : 0;
  std::uint32_t place = kFamily;
  for (const auto& [name, value] : plan.sampler->defines)
    words.at(place++) = static_cast<std::uint64_t>(value);
  return words;
}

// The largest set whose columns the table can have: all that the sampler declares. A set of one N
// has a table of its own, and a user's file may hold no more than was asked for.
std::uint64_t largest_set(const Plan& plan) {
  const auto& parameters = plan.sampler->parameters;
  const bool from_file = std::any_of(parameters.begin(), parameters.end(),
                                     [](const SamplerParameter& p) { return p.path; }) ||
                         !plan.request.directions_file.empty();
  if (!plan.sampler->extensible || from_file) return plan.request.end_index;
  return std::max(plan.request.end_index,
                  std::uint64_t{1} << std::min(plan.sampler->max_log2_n, 52U));
}

}  // namespace

std::string general_kernel(const Plan& plan) {
  return fmt::format("kernels/general/{}.cl", plan.sampler->family);
}

std::string general_defines(const Plan& plan) {
  const std::uint32_t states = std::max(kLeastStates, std::bit_ceil(interlaced(plan)));
  std::string text = fmt::format(
      "#define KOKSMA_SUM_WORDS {}\n#define KOKSMA_GENERAL_STATES {}\n"
      "#define KOKSMA_GENERAL_TABLE {}\n#define KOKSMA_GENERAL_DIM {}\n"
      "#define KOKSMA_GENERAL_SQUARES_OF {}\n#define KOKSMA_GENERAL_COUNTS {}\n"
      "#define KOKSMA_GENERAL_CENTRED {}\n",
      plan.sum_words(), states, kSwitchWords, kDim, kSquaresOf, kCounts, kCentred);
  std::uint32_t place = kFamily;
  for (const auto& define : plan.sampler->defines)
    text += fmt::format("#define {}_SWITCH {}\n", define.first, place++);
  return text;
}

std::optional<std::string> no_general_kernel(const Plan& plan) {
  if (plan.sampler->rotated) return "sets that are rotated have no general kernel";
  if (plan.coarse_coordinates) return "general kernels draw all bits";
  const auto files = embedded_files();
  const std::string path = general_kernel(plan);
  if (std::any_of(files.begin(), files.end(),
                  [&](const EmbeddedFile& file) { return file.path == path; }))
    return std::nullopt;
  std::string families;
  for (const EmbeddedFile& file : files)
    if (const std::string name(file.path); name.starts_with("kernels/general/")) {
      const std::string stem = name.substr(16, name.size() - 19);
      if (stem != "integrate" && stem != "switches")
        families += fmt::format("{}{}", families.empty() ? "" : ", ", stem);
    }
  return fmt::format("family '{}' has no general kernel; there are some for {}",
                     plan.sampler->family, families);
}

GeneralPlan general_plan(const Catalog& catalog, const Plan& plan) {
  if (const auto reason = no_general_kernel(plan)) throw UnsupportedError(*reason);
  Estimator all = *plan.estimator;
  all.moments = 3;
  GeneralPlan general{std::make_shared<const Estimator>(std::move(all)), plan};
  general.plan.estimator = general.estimator.get();
  general.plan.counters = false;  // a switch, not a kernel of its own
  general.plan.request.end_index = largest_set(plan);
  general.plan.request.centred_draws = false;  // one table for whatever draws from it
  general.plan.program = compose(catalog, general.plan, ProgramKind::general);
  return general;
}

std::vector<std::byte> general_table(const GeneralPlan& general) {
  const std::vector<std::uint64_t> words = switches(general.plan);
  const bool fp64 = general.plan.fp64();
  const std::size_t size = fp64 ? 8 : 4;
  std::vector<std::byte> bytes(words.size() * size);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto narrow = static_cast<std::uint32_t>(words[i]);
    std::memcpy(bytes.data() + i * size, fp64 ? static_cast<const void*>(&words[i]) : &narrow,
                size);
  }
  const std::vector<std::byte> table = build_point_table(general.plan);
  bytes.insert(bytes.end(), table.begin(), table.end());
  return bytes;
}

}  // namespace koksma
