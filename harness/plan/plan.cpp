#include "plan/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "error/error.hpp"
#include "plan/compose.hpp"
#include "plan/prune.hpp"
#include "plan/tuning.hpp"

namespace koksma {
namespace {

// Pairs of samples are neighbouring lanes, so an item must hold both; vectors begin at 4.
std::uint32_t least_lanes(const Estimator& estimator) {
  return estimator.second_moment.starts_with("pair") ? 4 : 1;
}

const SumAlgorithm& choose_sum(const Catalog& catalog, const Cell& cell,
                               const DeviceFacts& device) {
  if (!cell.sum.empty()) {
    const SumAlgorithm& asked = catalog.sum(cell.sum, "--sum");
    if (asked.needs_fp64 && !device.fp64)
      throw UnsupportedError(
          fmt::format("sum '{}' needs fp64, which {} lacks", asked.name, device.name));
    return asked;
  }
  const SumAlgorithm* best = nullptr;
  for (const SumAlgorithm& s : catalog.sums)
    if ((device.fp64 || !s.needs_fp64) && (best == nullptr || s.preference > best->preference))
      best = &s;
  return *best;
}

void set_precision(Plan& plan, Precision precision, const DeviceFacts& device) {
  if (precision == Precision::fp64 && !device.fp64)
    throw UnsupportedError(fmt::format("precision fp64 on {}, which lacks it", device.name));
  const auto& offered = plan.sampler->precisions;
  if (std::find(offered.begin(), offered.end(), precision_name(precision)) == offered.end())
    throw UnsupportedError(fmt::format("precision {} with sampler '{}', which needs {}",
                                       precision_name(precision), plan.sampler->name,
                                       offered.front()));
  plan.max_allocation = device.max_allocation;
  plan.device_fp64 = device.fp64;
  plan.fp_config32 = device.fp_config32;
  plan.fp_config64 = device.fp_config64;
  plan.precision = precision;
  plan.coordinate_bits = plan.fp64() && !plan.coarse_coordinates ? 52 : 23;
}

// Sizes that deterministic points cannot resolve (6-definitions 4): randomized ones are flagged
// instead.
bool resolves(const Plan& plan, std::uint64_t n) {
  return plan.sampler->centred || n <= std::uint64_t{1} << plan.coordinate_bits;
}

[[noreturn]] void refuse_resolution(const Plan& plan, std::uint64_t n) {
  throw UnsupportedError(
      fmt::format("sampler '{}' is exact to {} bits in {}: N = {} would repeat points",
                  plan.sampler->name, plan.coordinate_bits, precision_name(plan.precision), n));
}

// The code that the pieces hold and this plan does not reach, by piece.
void note_dropped_code(Plan& plan, const PrunedText& text) {
  if (text.bytes_of_branches > 0)
    plan.left_out.push_back(
        {"branches of other plans",
         fmt::format("{} bytes of the pieces' text are for other samplers, precisions, lanes or "
                     "estimators",
                     text.bytes_of_branches)});
  for (std::size_t i = 0; i < text.dropped.size();) {
    const std::string& path = text.dropped[i].path;
    std::size_t bytes = 0;
    std::string names;
    for (; i < text.dropped.size() && text.dropped[i].path == path; ++i) {
      bytes += text.dropped[i].bytes;
      const std::string& name = text.dropped[i].name;
      if (!name.empty()) names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
    }
    plan.left_out.push_back(
        {names.empty() ? path : fmt::format("{} of {}", names, path),
         fmt::format("nothing that is kept calls {}, {} bytes of text",
                     names.find(',') == std::string::npos ? "it" : "them", bytes)});
  }
}

void note_what_is_left_out(Plan& plan, const PrunedText& text) {
  const auto note = [&](std::string what, std::string why) {
    plan.left_out.push_back({std::move(what), std::move(why)});
  };
  note("the other samplers and integrands", "one program per cell");
  if (plan.estimator->moments == 1)
    note(
        "second moment",
        fmt::format("estimator '{}' takes its error from {}; it would double what a block stores, "
                    "{} bytes",
                    plan.estimator->name, plan.estimator->replicated ? "the replicates" : "nothing",
                    plan.words() * 16 * (plan.stores_doubles() ? 8 : 4)));
  if (!plan.counters)
    note("counters of exceptional samples",
         "a partial sum tells of a NaN or an infinity for free; only then a kernel that counts is "
         "built");
  if (plan.integrand->transforms.empty())
    note("transforms", fmt::format("'{}' asks for none", plan.integrand->name));
  if (plan.integrand->coefficients.empty())
    note("coefficient table", fmt::format("'{}' has none", plan.integrand->name));
  note("indices beyond N", fmt::format("tables that grow with N reach to index {} and no further",
                                       plan.request.end_index - 1));
  if (find_table_builder(plan.sampler->family) == nullptr)
    note("point tables", fmt::format("family '{}' computes its points", plan.sampler->family));
  if (!plan.cell.scene.dim || plan.sampler->max_dim > plan.cell.scene.dim)
    note("dimensions",
         fmt::format("{} of {} are drawn", plan.cell.scene.dim, plan.sampler->max_dim));
  note_dropped_code(plan, text);
}

// For kernels/rotate.cl: [0] where the points' own table begins; then, per replicate and dimension,
// the bits of the number 1 - u, u = (k + 1/2) 2^-m the shift.
std::vector<std::uint64_t> rotation_table(const PointRequest& request) {
  std::vector<std::uint64_t> words{0};
  for (std::uint32_t r = 0; r < request.replicates; ++r) {
    for (std::uint32_t d = 0; d < request.dim; ++d) {
      const std::uint64_t u = random_pair(request.seed, 0, r, RandomPurpose::rotation, d).first;
      const double complement = 1 - (std::ldexp(static_cast<double>(u >> 12), -52) + 0x1p-53);
      const float narrow =
          1 - (std::ldexp(static_cast<float>(static_cast<std::uint32_t>(u >> 41)), -23) + 0x1p-24F);
      words.push_back(request.fp64 ? std::bit_cast<std::uint64_t>(complement)
                                   : std::bit_cast<std::uint32_t>(narrow));
    }
  }
  // An even place, as some tables hold 64-bit words in fp32 too.
  if (words.size() % 2 != 0) words.push_back(0);
  words[0] = words.size();
  return words;
}

// What the family's sets ask of the device first, and what only the user's files can refuse.
void plan_preparation(const Catalog& catalog, Plan& plan, const DeviceFacts& device) {
  const PreparationBuilder prepare = find_preparation_builder(plan.sampler->family);
  if (prepare == nullptr) return;
  std::optional<Preparation> work = prepare(plan.request);
  if (!work) return;
  const std::uint64_t most = std::min<std::uint64_t>(64, device.max_work_group_size);
  const auto local_size = static_cast<std::uint32_t>(device.is_cpu ? 1 : most);
  ProgramSource program =
      compose_preparation(catalog.family(plan.sampler->family), work->piece, local_size);
  plan.preparation = {std::move(*work), std::move(program), local_size};
}

// Whether the kernel's text names the slot: no entry has to say it, or can be wrong about it.
bool draws_centred(const Integrand& f) {
  return source_text(f).find("points_next_centred") != std::string::npos;
}

}  // namespace

std::uint32_t log2_block_length(std::uint64_t n) {
  const auto log2_n = static_cast<std::uint32_t>(std::bit_width(n - 1));
  return std::clamp(log2_n, 14u, 22u) - 6;
}

Plan make_plan(const Catalog& catalog, const Cell& cell, const DeviceFacts& device,
               const std::string& directions_file, const PlanOptions& options) {
  Plan plan;
  plan.cell = cell;
  plan.relaxed_math = options.relaxed_math;
  plan.counters = options.counters;
  plan.coarse_coordinates = options.coarse_coordinates;
  plan.integrand = &catalog.integrand(cell.scene.integrand, "scene");
  plan.sampler = std::make_shared<const Sampler>(catalog.sampler(cell.sampler, "sampler"));
  plan.estimator = &catalog.estimator(cell.estimator, "estimator");
  set_precision(plan, cell.precision.value_or(device.fp64 ? Precision::fp64 : Precision::fp32),
                device);
  plan.sum = &choose_sum(catalog, cell, device);
  const std::uint32_t least = least_lanes(*plan.estimator);
  const ShapeChoice choice = options.shape
                                 ? ShapeChoice{*options.shape, false}
                                 : choose_shape(device, {plan.sampler.get(), plan.integrand,
                                                         cell.scene.dim, plan.precision, least});
  plan.shape = choice.shape;
  plan.shape_is_tuned = choice.tuned;
  plan.shape.lanes_per_item = std::max(plan.shape.lanes_per_item, least);
  plan.cell.n.clear();
  for (const std::uint64_t n : cell.n)
    (resolves(plan, n) ? plan.cell.n : plan.refused_n).push_back(n);
  if (plan.cell.n.empty()) refuse_resolution(plan, cell.n.front());
  plan.request = {plan.sampler->options,
                  cell.scene.dim,
                  plan.fp64(),
                  plan.cell.n.back(),
                  plan.launched_replicates(),
                  cell.seed,
                  directions_file,
                  nullptr,
                  {}};
  plan.request.centred_draws = !plan.sampler->rotated && draws_centred(*plan.integrand);
  plan_preparation(catalog, plan, device);
  plan.program = compose_whole(catalog, plan, ProgramKind::integrate);
  const PrunedText kept = pruned(plan.program.text);
  plan.program.text = kept.text;
  note_what_is_left_out(plan, kept);
  return plan;
}

Plan make_points_plan(const Catalog& catalog, const std::string& sampler, std::uint32_t dim,
                      Precision precision, std::uint64_t end_index, std::uint32_t replicates,
                      std::uint64_t seed, const DeviceFacts& device,
                      const std::string& directions_file, const std::optional<LaunchShape>& shape) {
  Plan plan;
  plan.sampler = std::make_shared<const Sampler>(catalog.sampler(sampler, "--sampler"));
  set_precision(plan, precision, device);
  plan.shape =
      shape ? *shape
            : choose_shape(device, {plan.sampler.get(), nullptr, dim, plan.precision, 1}).shape;
  plan.request = {plan.sampler->options, dim,     plan.fp64(), end_index, replicates, seed,
                  directions_file,       nullptr, {}};
  if (!resolves(plan, end_index)) refuse_resolution(plan, end_index);
  plan_preparation(catalog, plan, device);
  plan.program = compose(catalog, plan, ProgramKind::inspect);
  return plan;
}

namespace {

// The offsets in an fp32 table are 32-bit words themselves.
void check_table_size(const Plan& plan, std::uint64_t words, std::uint32_t replicates) {
  const std::size_t size = plan.fp64() ? 8 : 4;
  const std::uint64_t most =
      std::min<std::uint64_t>(plan.max_allocation / size, plan.fp64() ? UINT64_MAX : UINT32_MAX);
  if (words > most)
    throw UnsupportedError(
        fmt::format("the point table of '{}' takes {} bytes for {} replicates, {} can be used",
                    plan.sampler->name, words * size, replicates, most * size));
}

// Tables grow linearly with the replicates: those of one and two tell of many before any memory is
// taken.
constexpr std::uint32_t kManyReplicates = 64;
void check_many_replicates(const Plan& plan, PointRequest request, PointTableBuilder build) {
  const std::uint32_t replicates = request.replicates;
  if (replicates < kManyReplicates) return;
  request.replicates = 1;
  const std::uint64_t one = build(request).words.size();
  request.replicates = 2;
  const std::uint64_t two = build(request).words.size();
  check_table_size(plan, one + (two - one) * (replicates - 1), replicates);
}

}  // namespace

std::vector<std::byte> build_point_table(
    const Plan& plan, std::uint64_t n, const std::shared_ptr<const std::vector<double>>& prepared) {
  const PointTableBuilder build = find_table_builder(plan.sampler->family);
  PointRequest request = plan.request;
  if (prepared != nullptr) request.prepared = prepared;
  if (!plan.sampler->extensible && n > 0) request.end_index = n;
  std::vector<std::uint64_t> words;
  if (plan.sampler->rotated) words = rotation_table(request);
  if (build != nullptr) {
    check_many_replicates(plan, request, build);
    const std::vector<std::uint64_t> points = build(request).words;
    words.insert(words.end(), points.begin(), points.end());
  }
  if (words.empty()) words.push_back(0);
  check_table_size(plan, words.size(), request.replicates);
  const std::size_t size = plan.fp64() ? 8 : 4;
  std::vector<std::byte> bytes(words.size() * size);
  if (plan.fp64()) {
    std::memcpy(bytes.data(), words.data(), bytes.size());
  } else {
    for (std::size_t i = 0; i < words.size(); ++i) {
      const auto narrow = static_cast<std::uint32_t>(words[i]);
      std::memcpy(bytes.data() + i * size, &narrow, size);
    }
  }
  return bytes;
}

}  // namespace koksma
