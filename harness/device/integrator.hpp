// Runs a plan on a device: uploads once, launches per N, hands out partial sums.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "device/device.hpp"

namespace koksma {

// Partial sums of one word of one replicate, in no promised grouping: their exact sum is what
// counts, times 2^Plan::word_exponent(word).
using PartialSums = std::function<void(std::uint32_t word, std::uint32_t replicate,
                                       std::span<const double> partials)>;

class Integrator {
 public:
  // Builds the program, builds and uploads the tables. `coefficients` in double, rounded here to
  // the precision.
  Integrator(Device& device, const Plan& plan, const std::vector<double>& coefficients);
  // With a point table of the caller's instead of the plan's.
  Integrator(Device& device, const Plan& plan, const std::vector<double>& coefficients,
             const std::vector<std::byte>& table);

  // Sums samples 0 … n-1 of every replicate of the plan; y0 is subtracted before squaring. Returns
  // the seconds that the kernels ran by the device's clock. Memory use does not depend on n.
  double run(std::uint64_t n, double y0, const PartialSums& take);
  // The same for replicates 0 … replicates-1 only, and for blocks first_block … end_block-1 of
  // 2^log2_block samples.
  double run_blocks(std::uint64_t n, std::uint32_t log2_block, std::uint64_t first_block,
                    std::uint64_t end_block, std::uint32_t replicates, double y0,
                    const PartialSums& take);

  // f at the first `count` points of replicate 0, count a multiple of 16. Of a set that is not
  // extensible those of the cell's largest N that is not above count, or of its smallest N.
  std::vector<double> first_values(std::uint64_t count = 16);
  // Uploads the table of the set of n points, where sets of different n have different ones.
  void prepare(std::uint64_t n);
  // Non-finite samples among the first n of all replicates; builds the counting kernel on first
  // use.
  std::uint64_t count_nonfinite(const Catalog& catalog, std::uint64_t n);

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
  };
  double launch(cl::Kernel& kernel, const Launch& launch);
  void read_partials(const Launch& launch, const PartialSums& take);
  template <typename Body>
  double for_each_launch(std::uint64_t n, std::uint32_t log2_block, std::uint64_t first_block,
                         std::uint64_t end_block, std::uint32_t replicates, double y0,
                         cl::Kernel& kernel, Body&& body);

  Device& device_;
  const Plan& plan_;
  cl::Kernel kernel_, counting_kernel_;
  cl::Buffer table_, values_, coefficients_, out_, counts_;
  std::uint64_t table_n_ = 0;  // of sets that are not extensible: the N that table_ is for
  std::size_t out_bytes_ = 0;
  std::vector<std::byte> raw_;
  std::vector<double> doubles_;
  double build_s_ = 0, setup_s_ = 0;
  std::size_t table_bytes_ = 0, coefficient_bytes_ = 0;
};

}  // namespace koksma
