#include "device/integrator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "device/arguments.hpp"
#include "device/prepare.hpp"
#include "plan/tuning.hpp"

namespace koksma {
namespace {

using Clock = std::chrono::steady_clock;

// The arguments of `integrate` (kernels/integrate.cl).
enum Argument : cl_uint {
  kTable,
  kValues,
  kCoefficients,
  kFirstBlock,
  kBlocks,
  kN,
  kSeed,
  kLog2Block,
  kFirstReplicate,
  kY0,
  kOutput,
  kCounters
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
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
    : device_(device), plan_(plan), ahead_(!device.facts().is_cpu) {
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

// Counters have one buffer, so a launch that counts is never queued ahead.
template <typename Body>
double Integrator::for_each_launch(std::uint64_t n, std::uint32_t log2_block,
                                   std::uint64_t first_block, std::uint64_t end_block,
                                   std::uint32_t replicates, double y0, cl::Kernel& kernel,
                                   Body&& body) {
  const std::uint64_t most = plan_.shape.items_per_launch.value_or(kItemsPerLaunch);
  const auto replicates_at_once =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(replicates, most));
  const std::uint64_t blocks_at_once = std::max<std::uint64_t>(most / replicates_at_once, 1);
  double seconds = 0;
  std::vector<Flight> flights;  // one, or two while the next is queued behind it
  const auto finish = [&] {
    if (flights.empty()) return;
    seconds += land(flights.front());
    body(flights.front());
    release(flights.front());
    flights.erase(flights.begin());
  };
  try {
    for (std::uint64_t block = first_block; block < end_block; block += blocks_at_once) {
      for (std::uint32_t r = 0; r < replicates; r += replicates_at_once) {
        const Launch next{n,          block, std::min(blocks_at_once, end_block - block),
                          log2_block, r,     std::min(replicates_at_once, replicates - r),
                          y0};
        if (!ahead_ || counts(kernel)) finish();
        flights.push_back(start(kernel, next));
        if (flights.size() > 1) finish();
      }
    }
    finish();
  } catch (...) {  // nothing may stay mapped: the next launch writes there
    for (Flight& flight : flights) release(flight);
    throw;
  }
  return seconds;
}

double Integrator::run(std::uint64_t n, double y0, const PartialSums& take) {
  const Launch l = whole_run(n, y0);
  if (!plan_.counters) return run_blocks(n, l.log2_block, 0, l.blocks, l.replicates, y0, take);
  begin_counters(n);
  const double seconds = for_each_launch(n, l.log2_block, 0, l.blocks, l.replicates, y0, kernel_,
                                         [&](const Flight& landed) {
                                           hand_out(landed, take);
                                           read_counters(landed.launch);
                                         });
  finish_counters();
  return seconds;
}

double Integrator::run_blocks(std::uint64_t n, std::uint32_t log2_block, std::uint64_t first_block,
                              std::uint64_t end_block, std::uint32_t replicates, double y0,
                              const PartialSums& take) {
  return for_each_launch(n, log2_block, first_block, end_block, replicates, y0, kernel_,
                         [&](const Flight& landed) { hand_out(landed, take); });
}

std::size_t Integrator::partial_sums(const Launch& l) const {
  return std::size_t{plan_.words()} * l.replicates * l.blocks * kLanes;
}

cl::Buffer& Integrator::next_output(std::size_t bytes) {
  Output& output = outputs_[next_output_];
  next_output_ = 1 - next_output_;
  if (bytes > output.bytes) {
    output.buffer = device_.allocate(bytes);
    output.bytes = bytes;
  }
  return output.buffer;
}

std::size_t Integrator::output_bytes(const Launch& l) const {
  return partial_sums(l) * l.runs * (plan_.stores_doubles() ? 8 : 4);
}

void Integrator::set_arguments(cl::Kernel& kernel, const Launch& l, const cl::Buffer& output) {
  kernel.setArg(kTable, table_);
  kernel.setArg(kValues, values_);
  kernel.setArg(kCoefficients, coefficients_);
  kernel.setArg(kFirstBlock, cl_ulong{l.first_block});
  set_size_arguments(kernel, l);
  kernel.setArg(kSeed, cl_ulong{plan_.cell.seed});
  kernel.setArg(kFirstReplicate, cl_uint{l.first_replicate});
  set_real(kernel, kY0, l.y0, plan_.stores_doubles());
  kernel.setArg(kOutput, output);
  if (counts(kernel)) set_counter_arguments(kernel, kCounters, l);
}

void Integrator::set_size_arguments(cl::Kernel& kernel, const Launch& l) {
  kernel.setArg(kBlocks, cl_ulong{l.blocks});
  kernel.setArg(kN, cl_ulong{l.n});
  kernel.setArg(kLog2Block, cl_uint{l.log2_block});
}

cl::Event Integrator::enqueue(cl::Kernel& kernel, const Launch& l) {
  const std::uint64_t items = l.blocks * (kLanes / plan_.shape.lanes_per_item);
  cl::Event event;
  device_.queue().enqueueNDRangeKernel(
      kernel, cl::NullRange,
      cl::NDRange(rounded_up(items, plan_.shape.local_size), l.replicates, l.runs),
      cl::NDRange(plan_.shape.local_size, 1, 1), nullptr, &event);
  return event;
}

// One wait covers the kernel and the sums: mapping them is queued right behind it, and where the
// device shares the host's memory nothing is copied.
Integrator::Flight Integrator::start(cl::Kernel& kernel, const Launch& l) {
  prepare(l.n);
  return checked([&] {
    const std::size_t bytes = output_bytes(l);
    Flight flight{l, {}, {}, nullptr, next_output(bytes)};
    set_arguments(kernel, l, flight.output);
    flight.kernel = enqueue(kernel, l);
    flight.partials = device_.queue().enqueueMapBuffer(flight.output, CL_FALSE, CL_MAP_READ, 0,
                                                       bytes, nullptr, &flight.mapped);
    device_.queue().flush();
    return flight;
  });
}

Integrator::Launch Integrator::whole_run(std::uint64_t n, double y0) const {
  const std::uint32_t b = log2_block(n);
  const std::uint64_t blocks = rounded_up(n, std::uint64_t{1} << b) >> b;
  return {n, 0, blocks, b, 0, plan_.launched_replicates(), y0};
}

std::uint32_t Integrator::runs_at_once(std::uint64_t n) const {
  if (plan_.counters) return 0;
  const Launch whole = whole_run(n, 0);
  return static_cast<std::uint32_t>(plan_.shape.items_per_launch.value_or(kItemsPerLaunch) /
                                    (whole.blocks * whole.replicates));
}

bool Integrator::fills_device(std::uint64_t n) const {
  const DeviceFacts& facts = device_.facts();
  const Launch whole = whole_run(n, 0);
  const std::uint64_t items =
      whole.blocks * whole.replicates * (kLanes / plan_.shape.lanes_per_item);
  return items / plan_.shape.local_size >=
         std::uint64_t{facts.compute_units} * (facts.is_cpu ? 8 : 32);
}

std::vector<double> Integrator::times_together(std::span<const RepeatedRun> launches, double y0) {
  prepare(launches.front().n);
  const auto launch_of = [&](const RepeatedRun& repeated) {
    Launch launch = whole_run(repeated.n, y0);
    launch.runs = repeated.runs;
    return launch;
  };
  return checked([&] {
    std::size_t bytes = 0;
    for (const RepeatedRun& l : launches) bytes = std::max(bytes, output_bytes(launch_of(l)));
    const cl::Buffer output = next_output(bytes);
    std::vector<cl::Event> events;
    set_arguments(kernel_, launch_of(launches.front()), output);
    for (const RepeatedRun& l : launches) {
      // On a CPU the host takes a core from the launch before, so no more is done than must be.
      const Launch launch = launch_of(l);
      set_size_arguments(kernel_, launch);
      events.push_back(enqueue(kernel_, launch));
    }
    events.back().wait();  // flushes; the queue keeps the order
    std::vector<double> seconds;
    for (std::size_t i = 0; i < events.size(); ++i)
      seconds.push_back(event_seconds(events[i]) / launches[i].runs);
    return seconds;
  });
}

double Integrator::land(Flight& flight) {
  return checked([&] {
    flight.mapped.wait();
    return event_seconds(flight.kernel);
  });
}

void Integrator::release(Flight& flight) {
  if (flight.partials == nullptr) return;
  checked([&] { return device_.queue().enqueueUnmapMemObject(flight.output, flight.partials); });
  flight.partials = nullptr;
}

void Integrator::hand_out(const Flight& flight, const PartialSums& take) {
  const Launch& l = flight.launch;
  const std::size_t count = partial_sums(l);
  std::span<const double> sums;
  if (plan_.stores_doubles()) {
    sums = {static_cast<const double*>(flight.partials), count};
  } else {
    const auto* narrow = static_cast<const float*>(flight.partials);
    doubles_.assign(narrow, narrow + count);
    sums = doubles_;
  }
  const std::size_t per_replicate = l.blocks * kLanes;
  std::size_t offset = 0;
  for (std::uint32_t word = 0; word < plan_.words(); ++word)
    for (std::uint32_t r = 0; r < l.replicates; ++r, offset += per_replicate)
      take(word, l.first_replicate + r, sums.subspan(offset, per_replicate));
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
  const Launch l = whole_run(n, 0);
  begin_counters(n);
  for_each_launch(n, l.log2_block, 0, l.blocks, l.replicates, 0,
                  plan_.counters ? kernel_ : counting_kernel_,
                  [&](const Flight& landed) { read_counters(landed.launch); });
  finish_counters();
  return counters_;
}

}  // namespace koksma
