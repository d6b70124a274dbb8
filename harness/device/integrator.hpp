// Runs a plan on a device: uploads once, launches per N, hands out partial sums.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "device/device.hpp"

namespace koksma {

// Partial sums of one word of one replicate, in no promised grouping: their exact sum is what
// counts, times 2^Plan::word_exponent(word).
using PartialSums = std::function<void(std::uint32_t word, std::uint32_t replicate,
                                       std::span<const double> partials)>;

// What the samples of all replicates of a run were, told from their bits (5-numerics 2.5), and two
// sums of their sizes. The counts do not depend on the launch shape, the sums not on the launch
// split.
struct Counters {
  std::uint64_t samples = 0;
  std::uint64_t nan = 0, plus_inf = 0, minus_inf = 0;
  // Values f, and (once per cell) parameters and coefficients as the kernel holds them, that are
  // denormal. Coordinates never are: they are 0 or at least half a unit of the last bit kept,
  // 2^-53.
  std::uint64_t denorm_out = 0, denorm_in = 0;
  // Samples with a coordinate <= 0, and with one >= 1 or NaN.
  std::uint64_t coord_le0 = 0, coord_ge1 = 0;
  std::uint64_t hits = 0;      // f is not 0
  std::uint64_t blow_ups = 0;  // |f| is above the limit, infinities included
  // Of the finite samples; the sums are of |f| / unit and (f / unit)^2, unit a power of two near
  // E|f|, naively added per lane in fp64 where the device has it.
  double max_abs = 0, sum_abs = 0, sum_squares = 0, unit = 1;

  std::uint64_t nonfinite() const { return nan + plus_inf + minus_inf; }
  // The effective number of samples (sum |f|)^2 / sum f^2, in [1, hits]. Empty where a sample is
  // not finite, no sample is hit, or a square over- or underflows even in that unit.
  std::optional<double> n_eff() const;
  // The condition number sum |f| / |sum f| >= 1 of the sum. Empty where a sample is not finite or
  // the quotient is.
  std::optional<double> kappa(double sum) const;
};

// One launch that makes the same run of n samples `runs` times.
struct RepeatedRun {
  std::uint64_t n = 0;
  std::uint32_t runs = 1;
};

class Integrator {
 public:
  // Builds the program, builds and uploads the tables. `coefficients` in double, rounded here to
  // the precision.
  Integrator(Device& device, const Plan& plan, const std::vector<double>& coefficients);
  // With a point table of the caller's instead of the plan's.
  Integrator(Device& device, const Plan& plan, const std::vector<double>& coefficients,
             const std::vector<std::byte>& table);

  // What samples are counted against: |f| above `blow_up` is a blow-up (clamped to the normal
  // numbers of the cell's precision); `typical`: about E|f|, above 0, for the unit of the sums. To
  // be called before samples are counted; at first nothing finite is a blow-up and the unit is 1.
  void count_against(double blow_up, double typical);

  // Sums samples 0 … n-1 of every replicate of the plan; y0 is subtracted before squaring. Returns
  // the seconds that the kernels ran by the device's clock. Memory use does not depend on n.
  double run(std::uint64_t n, double y0, const PartialSums& take);
  // The same for replicates 0 … replicates-1 only, and for blocks first_block … end_block-1 of
  // 2^log2_block samples.
  double run_blocks(std::uint64_t n, std::uint32_t log2_block, std::uint64_t first_block,
                    std::uint64_t end_block, std::uint32_t replicates, double y0,
                    const PartialSums& take);

  // How many runs of n samples one launch has room for, as times_together() may have them; 0 where
  // a run takes several launches or the plan counts samples.
  std::uint32_t runs_at_once(std::uint64_t n) const;
  // Whether a run of n samples has work-groups enough to keep all compute units busy: 8 for each on
  // CPUs, 32 elsewhere.
  bool fills_device(std::uint64_t n) const;
  // Kernel seconds of one run in each of these launches (not empty), in that order, queued behind
  // each other and waited for once, so that the device does not wait for the host between them.
  // Their sums are not read. Each 1 … runs_at_once() runs; n all the same where the sampler is not
  // extensible.
  std::vector<double> times_together(std::span<const RepeatedRun> launches, double y0);

  // f at the first `count` points of replicate 0, count a multiple of 16. Of a set that is not
  // extensible those of the cell's largest N that is not above count, or of its smallest N.
  std::vector<double> first_values(std::uint64_t count = 16);
  // Whether the next launch is queued before `take` gets the sums of the last one. At first on
  // devices other than CPUs: there a launch would share the cores with `take`, and its time with
  // it.
  void queue_ahead(bool ahead) { ahead_ = ahead; }
  // Uploads the table of the set of n points, where sets of different n have different ones.
  void prepare(std::uint64_t n);
  // Of the last run(), where the plan has counters.
  const Counters& counters() const { return counters_; }
  // Of the first n samples of all replicates, in a run of its own; builds the kernel that counts on
  // first use.
  const Counters& count(const Catalog& catalog, std::uint64_t n);

  double build_s() const { return build_s_; }
  double setup_s() const { return setup_s_; }
  std::size_t table_bytes() const { return table_bytes_; }
  std::size_t coefficient_bytes() const { return coefficient_bytes_; }
  std::uint32_t log2_block(std::uint64_t n) const;

 private:
  struct Launch {
    std::uint64_t n, first_block, blocks;
    std::uint32_t log2_block, first_replicate, replicates;
    double y0;
    std::uint32_t runs = 1;
  };
  // A launch on its way, with the partial sums that it leaves in one of the two output buffers.
  struct Flight {
    Launch launch;
    cl::Event kernel, mapped;
    void* partials = nullptr;  // valid once `mapped` is complete, until release()
    cl::Buffer output;
  };
  Launch whole_run(std::uint64_t n, double y0) const;
  std::size_t output_bytes(const Launch& launch) const;
  void set_arguments(cl::Kernel& kernel, const Launch& launch, const cl::Buffer& output);
  // Those among them that launches of runs of different sizes differ in.
  void set_size_arguments(cl::Kernel& kernel, const Launch& launch);
  // Queues the launch, its arguments set, and returns its event.
  cl::Event enqueue(cl::Kernel& kernel, const Launch& launch);
  Flight start(cl::Kernel& kernel, const Launch& launch);
  double land(Flight& flight);
  void release(Flight& flight);
  cl::Buffer& next_output(std::size_t bytes);
  std::size_t partial_sums(const Launch& launch) const;  // of one run
  bool counts(const cl::Kernel& kernel) const;
  void set_counter_arguments(cl::Kernel& kernel, cl_uint arg, const Launch& launch);
  void hand_out(const Flight& flight, const PartialSums& take);
  // `count` reals of the buffer, into doubles_.
  void read_reals(const cl::Buffer& buffer, std::size_t count, bool fp64);
  void begin_counters(std::uint64_t n);
  void read_counters(const Launch& launch);
  void finish_counters();
  template <typename Body>
  double for_each_launch(std::uint64_t n, std::uint32_t log2_block, std::uint64_t first_block,
                         std::uint64_t end_block, std::uint32_t replicates, double y0,
                         cl::Kernel& kernel, Body&& body);

  Device& device_;
  const Plan& plan_;
  cl::Kernel kernel_, counting_kernel_;
  cl::Buffer table_, values_, coefficients_, counts_, sizes_;
  // Launches alternate between two, so that one is merged while the other is written.
  struct Output {
    cl::Buffer buffer;
    std::size_t bytes = 0;
  };
  std::array<Output, 2> outputs_;
  std::size_t next_output_ = 0;
  bool ahead_ = false;
  std::uint64_t table_n_ = 0;  // of sets that are not extensible: the N that table_ is for
  std::size_t counted_items_ = 0;
  std::vector<std::byte> raw_;
  std::vector<double> doubles_;
  double build_s_ = 0, setup_s_ = 0;
  std::size_t table_bytes_ = 0, coefficient_bytes_ = 0;
  double blow_up_ = 0;
  std::uint64_t denorm_in_ = 0;
  Counters counters_;
  std::vector<double> sums_abs_, sums_squares_;  // per replicate, of the run that is counted
};

}  // namespace koksma
