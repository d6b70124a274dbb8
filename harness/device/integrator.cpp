#include "device/integrator.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "device/prepare.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kLanes = 16;
// Bound on blocks x replicates of a launch: 2^13 * 16 partial sums are 1 MiB per word, enough items
// for any device.
constexpr std::uint64_t kBlocksPerLaunch = std::uint64_t{1} << 13;

// ulong words of a work-item that counts: the counters in the order of counters_store
// (kernels/counters.cl), then the bits of the largest |f|.
constexpr std::size_t kCounterWords = 9;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void set_real(cl::Kernel& kernel, cl_uint index, double value, bool fp64) {
  if (fp64)
    kernel.setArg(index, cl_double{value});
  else
    kernel.setArg(index, static_cast<cl_float>(value));
}

// Numbers that are denormal once the kernel's precision holds them.
std::uint64_t count_denormal(const std::vector<double>& values, bool fp64) {
  return static_cast<std::uint64_t>(std::count_if(values.begin(), values.end(), [&](double value) {
    return (fp64 ? std::fpclassify(value) : std::fpclassify(static_cast<float>(value))) ==
           FP_SUBNORMAL;
  }));
}

std::uint64_t rounded_up(std::uint64_t value, std::uint64_t unit) {
  return (value + unit - 1) / unit * unit;
}

}  // namespace

Integrator::Integrator(Device& device, const Plan& plan, const std::vector<double>& coefficients)
    : Integrator(device, plan, coefficients, {}) {}

Integrator::Integrator(Device& device, const Plan& plan, const std::vector<double>& coefficients,
                       const std::vector<std::byte>& given_table)
    : device_(device), plan_(plan) {
  const BuiltProgram built = device.build(plan.program);
  build_s_ = built.build_s;
  const auto start = Clock::now();
  kernel_ = checked([&] { return cl::Kernel(built.program, "integrate"); });
  const std::vector<std::byte> table =
      given_table.empty() ? point_table(device, plan) : given_table;
  table_bytes_ = table.size();
  table_ = device.upload(table.data(), table.size());
  table_n_ = plan.request.end_index;
  values_ = device.upload_reals(plan.cell.scene.parameters, plan.fp64());
  coefficients_ = device.upload_reals(coefficients, plan.fp64());
  coefficient_bytes_ = coefficients.size() * (plan.fp64() ? 8 : 4);
  denorm_in_ = count_denormal(plan.cell.scene.parameters, plan.fp64()) +
               count_denormal(coefficients, plan.fp64());
  count_against(INFINITY, 1);
  setup_s_ = seconds_since(start);
}

void Integrator::prepare(std::uint64_t n) {
  if (plan_.sampler->extensible || n == table_n_) return;
  const auto start = Clock::now();
  const std::vector<std::byte> table = point_table(device_, plan_, n);
  table_ = device_.upload(table.data(), table.size());
  table_n_ = n;
  table_bytes_ = std::max(table_bytes_, table.size());
  setup_s_ += seconds_since(start);
}

std::uint32_t Integrator::log2_block(std::uint64_t n) const {
  return plan_.shape.log2_block.value_or(log2_block_length(n));
}

template <typename Body>
double Integrator::for_each_launch(std::uint64_t n, std::uint32_t log2_block,
                                   std::uint64_t first_block, std::uint64_t end_block,
                                   std::uint32_t replicates, double y0, cl::Kernel& kernel,
                                   Body&& body) {
  const std::uint64_t most = plan_.shape.items_per_launch.value_or(kBlocksPerLaunch);
  const auto replicates_at_once =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(replicates, most));
  const std::uint64_t blocks_at_once = std::max<std::uint64_t>(most / replicates_at_once, 1);
  double seconds = 0;
  for (std::uint64_t block = first_block; block < end_block; block += blocks_at_once) {
    for (std::uint32_t r = 0; r < replicates; r += replicates_at_once) {
      const Launch launch_now{n,          block, std::min(blocks_at_once, end_block - block),
                              log2_block, r,     std::min(replicates_at_once, replicates - r),
                              y0};
      seconds += launch(kernel, launch_now);
      body(launch_now);
    }
  }
  return seconds;
}

double Integrator::run(std::uint64_t n, double y0, const PartialSums& take) {
  const std::uint32_t b = log2_block(n);
  const std::uint64_t blocks = rounded_up(n, std::uint64_t{1} << b) >> b;
  if (!plan_.counters) return run_blocks(n, b, 0, blocks, plan_.launched_replicates(), y0, take);
  begin_counters(n);
  const double seconds = for_each_launch(n, b, 0, blocks, plan_.launched_replicates(), y0, kernel_,
                                         [&](const Launch& launched) {
                                           read_partials(launched, take);
                                           read_counters(launched);
                                         });
  finish_counters();
  return seconds;
}

double Integrator::run_blocks(std::uint64_t n, std::uint32_t log2_block, std::uint64_t first_block,
                              std::uint64_t end_block, std::uint32_t replicates, double y0,
                              const PartialSums& take) {
  return for_each_launch(n, log2_block, first_block, end_block, replicates, y0, kernel_,
                         [&](const Launch& launched) { read_partials(launched, take); });
}

double Integrator::launch(cl::Kernel& kernel, const Launch& l) {
  prepare(l.n);
  return checked([&] {
    const std::size_t bytes = std::size_t{plan_.words()} * l.replicates * l.blocks * kLanes *
                              (plan_.stores_doubles() ? 8 : 4);
    if (bytes > out_bytes_) {
      out_ = device_.allocate(bytes);
      out_bytes_ = bytes;
    }
    cl_uint arg = 0;
    kernel.setArg(arg++, table_);
    kernel.setArg(arg++, values_);
    kernel.setArg(arg++, coefficients_);
    for (const std::uint64_t value : {l.first_block, l.blocks, l.n, plan_.cell.seed})
      kernel.setArg(arg++, cl_ulong{value});
    kernel.setArg(arg++, cl_uint{l.log2_block});
    kernel.setArg(arg++, cl_uint{l.first_replicate});
    set_real(kernel, arg++, l.y0, plan_.stores_doubles());
    kernel.setArg(arg++, out_);
    if (counts(kernel)) set_counter_arguments(kernel, arg, l);
    const std::uint64_t items = l.blocks * (kLanes / plan_.shape.lanes_per_item);
    cl::Event event;
    device_.queue().enqueueNDRangeKernel(
        kernel, cl::NullRange, cl::NDRange(rounded_up(items, plan_.shape.local_size), l.replicates),
        cl::NDRange(plan_.shape.local_size, 1), nullptr, &event);
    event.wait();
    return event_seconds(event);
  });
}

void Integrator::read_reals(const cl::Buffer& buffer, std::size_t count, bool fp64) {
  doubles_.resize(count);
  if (fp64) {
    checked([&] {
      return device_.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(double),
                                               doubles_.data());
    });
    return;
  }
  raw_.resize(count * sizeof(float));
  checked([&] {
    return device_.queue().enqueueReadBuffer(buffer, CL_TRUE, 0, raw_.size(), raw_.data());
  });
  for (std::size_t i = 0; i < count; ++i) {
    float narrow = 0;
    std::memcpy(&narrow, raw_.data() + i * sizeof(float), sizeof(float));
    doubles_[i] = narrow;
  }
}

void Integrator::read_partials(const Launch& l, const PartialSums& take) {
  const std::size_t per_replicate = l.blocks * kLanes;
  const std::size_t count = per_replicate * l.replicates * plan_.words();
  read_reals(out_, count, plan_.stores_doubles());
  std::size_t offset = 0;
  for (std::uint32_t word = 0; word < plan_.words(); ++word)
    for (std::uint32_t r = 0; r < l.replicates; ++r, offset += per_replicate)
      take(word, l.first_replicate + r, std::span(doubles_).subspan(offset, per_replicate));
}

std::vector<double> Integrator::first_values(std::uint64_t count) {
  // Blocks of 16 samples: every lane's partial sum is one value; a sum of several words adds up to
  // it.
  std::uint64_t n = plan_.sampler->extensible ? count : plan_.cell.n.front();
  if (!plan_.sampler->extensible)
    for (const std::uint64_t size : plan_.cell.n)
      if (size <= count) n = std::max(n, size);
  const std::uint64_t blocks = std::min(count, rounded_up(n, kLanes)) / kLanes;
  std::vector<double> values(blocks * kLanes, 0.0);
  std::vector<std::size_t> filled(plan_.sum_words(), 0);
  run_blocks(n, 4, 0, blocks, 1, 0.0,
             [&](std::uint32_t word, std::uint32_t, std::span<const double> partials) {
               if (word >= plan_.sum_words()) return;  // squares
               const int exponent = plan_.word_exponent(word);
               for (const double partial : partials)
                 values[filled[word]++] += std::ldexp(partial, exponent);
             });
  values.resize(std::min<std::uint64_t>(values.size(), n));
  return values;
}

const Counters& Integrator::count(const Catalog& catalog, std::uint64_t n) {
  if (!plan_.counters && counting_kernel_() == nullptr) {
    const BuiltProgram built = device_.build(counting_program(catalog, plan_));
    counting_kernel_ = checked([&] { return cl::Kernel(built.program, "integrate"); });
  }
  const std::uint32_t b = log2_block(n);
  begin_counters(n);
  for_each_launch(n, b, 0, rounded_up(n, std::uint64_t{1} << b) >> b, plan_.launched_replicates(),
                  0.0, plan_.counters ? kernel_ : counting_kernel_,
                  [&](const Launch& launched) { read_counters(launched); });
  finish_counters();
  return counters_;
}

bool Integrator::counts(const cl::Kernel& kernel) const {
  return plan_.counters || &kernel == &counting_kernel_;
}

void Integrator::count_against(double blow_up, double typical) {
  const double most =
      plan_.fp64() ? std::numeric_limits<double>::max() : double{std::numeric_limits<float>::max()};
  const double least =
      plan_.fp64() ? std::numeric_limits<double>::min() : double{std::numeric_limits<float>::min()};
  blow_up_ = std::clamp(blow_up, least, most);
  // The kernel multiplies by 1 / unit, which must be a normal number too.
  const int range = plan_.device_fp64 ? 1022 : 126;
  counters_.unit = std::ldexp(1.0, std::clamp(std::ilogb(typical), -range, range));
}

void Integrator::set_counter_arguments(cl::Kernel& kernel, cl_uint arg, const Launch& l) {
  const std::size_t items =
      std::size_t{l.blocks} * (kLanes / plan_.shape.lanes_per_item) * l.replicates;
  if (items > counted_items_) {
    counts_ = device_.allocate(items * kCounterWords * sizeof(std::uint64_t));
    sizes_ = device_.allocate(items * 2 * sizeof(double));
    counted_items_ = items;
  }
  set_real(kernel, arg++, blow_up_, plan_.fp64());
  set_real(kernel, arg++, 1 / counters_.unit, plan_.device_fp64);
  kernel.setArg(arg++, counts_);
  kernel.setArg(arg++, sizes_);
}

void Integrator::begin_counters(std::uint64_t n) {
  const double unit = counters_.unit;
  counters_ = {};
  counters_.unit = unit;
  counters_.samples = n * plan_.launched_replicates();
  counters_.denorm_in = denorm_in_;
  sums_abs_.assign(plan_.launched_replicates(), 0.0);
  sums_squares_.assign(plan_.launched_replicates(), 0.0);
}

void Integrator::read_counters(const Launch& l) {
  const std::size_t items = l.blocks * (kLanes / plan_.shape.lanes_per_item) * l.replicates;
  std::vector<std::uint64_t> words(items * kCounterWords);
  checked([&] {
    return device_.queue().enqueueReadBuffer(counts_, CL_TRUE, 0, words.size() * sizeof words[0],
                                             words.data());
  });
  const auto word = [&](std::size_t k) { return std::span(words).subspan(k * items, items); };
  std::size_t k = 0;
  for (std::uint64_t* total :
       {&counters_.nan, &counters_.plus_inf, &counters_.minus_inf, &counters_.denorm_out,
        &counters_.coord_le0, &counters_.coord_ge1, &counters_.hits, &counters_.blow_ups})
    for (const std::uint64_t count : word(k++)) *total += count;
  for (const std::uint64_t pattern : word(k))
    counters_.max_abs =
        std::max(counters_.max_abs,
                 plan_.fp64() ? std::bit_cast<double>(pattern)
                              : double{std::bit_cast<float>(static_cast<std::uint32_t>(pattern))});
  // Blocks come in order within a replicate whatever the launch split, and so are added.
  const std::size_t per_replicate = items / l.replicates;
  read_reals(sizes_, items * 2, plan_.device_fp64);
  auto size = doubles_.cbegin();
  for (std::vector<double>* sums : {&sums_abs_, &sums_squares_})
    for (std::uint32_t r = 0; r < l.replicates; ++r)
      for (std::size_t i = 0; i < per_replicate; ++i) (*sums)[l.first_replicate + r] += *size++;
}

void Integrator::finish_counters() {
  counters_.sum_abs = std::accumulate(sums_abs_.begin(), sums_abs_.end(), 0.0);
  counters_.sum_squares = std::accumulate(sums_squares_.begin(), sums_squares_.end(), 0.0);
}

std::optional<double> Counters::n_eff() const {
  const double squared = sum_abs * sum_abs;
  if (nonfinite() > 0 || !(squared > 0 && sum_squares > 0) || !std::isfinite(squared) ||
      !std::isfinite(sum_squares))
    return std::nullopt;
  return squared / sum_squares;
}

std::optional<double> Counters::kappa(double sum) const {
  const double quotient = sum_abs / std::fabs(sum / unit);
  if (nonfinite() > 0 || !std::isfinite(quotient)) return std::nullopt;
  return quotient;
}

}  // namespace koksma
