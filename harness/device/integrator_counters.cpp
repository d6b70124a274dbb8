// The integrator's counters of exceptional samples: arguments, reading, merging.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "device/arguments.hpp"
#include "device/integrator.hpp"

namespace koksma {
namespace {

// ulong words of a work-item that counts: the counters in the order of counters_store
// (kernels/counters.cl), then the bits of the largest |f|.
constexpr std::size_t kCounterWords = 9;

}  // namespace

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
