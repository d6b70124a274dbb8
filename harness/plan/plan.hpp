// cell x device facts -> plan: what the cell needs and therefore what its kernel contains, uploads
// and stores. The only place that knows the composition of programs (kernels/README.md) and what
// fits together.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "points/tables.hpp"
#include "study/study.hpp"

namespace koksma {

struct Tuning;  // plan/tuning.hpp

// What planning must know of a device; filled by the device stage.
struct DeviceFacts {
  std::string name, vendor, driver, platform, version;
  bool is_cpu = true;
  bool fp64 = true;
  std::uint32_t compute_units = 1;
  std::uint64_t max_work_group_size = 1;
  std::uint64_t max_allocation = 0;  // bytes
  // CL_DEVICE_SINGLE_FP_CONFIG and its double twin, names without CL_FP_, joined by "|".
  std::string fp_config32, fp_config64;
  // Launch shapes that `koksma tune` timed on it; nullptr: none, or not to be used.
  std::shared_ptr<const Tuning> tuning;
};

// Choices that must not change results; tests vary them.
struct LaunchShape {
  std::uint32_t lanes_per_item = 16;  // 1, 4, 8 or 16
  std::uint32_t local_size = 1;
  std::optional<std::uint32_t> log2_block;        // recorded: it does change the bits of the sums
  std::optional<std::uint64_t> items_per_launch;  // blocks x replicates bound
};

// The option that PlanOptions::relaxed_math adds.
inline constexpr const char* kRelaxedMathOption = "-cl-fast-relaxed-math";

// What `koksma stability` asks of a plan and no other verb does.
struct PlanOptions {
  std::optional<LaunchShape> shape;  // empty: the device's
  bool relaxed_math = false;        // -cl-fast-relaxed-math: to see what it breaks, never to report
  bool counters = false;            // exceptional samples, hits and sums of |f| and f^2 are counted
  bool coarse_coordinates = false;  // fp64 evaluates at the 23-bit coordinates of fp32
};

// A program in source form.
struct ProgramSource {
  std::string name;  // for messages: "genz-gaussian with sobol-owen"
  std::string text;
  std::string options;
};

// A preparation with the program that holds its kernels.
struct PlannedPreparation {
  Preparation work;
  ProgramSource program;
  std::uint32_t local_size = 1;  // of every launch
};

struct LeftOut {
  std::string what, why;
};

struct Plan {
  Cell cell;
  const Integrand* integrand = nullptr;
  std::shared_ptr<const Sampler> sampler;
  const Estimator* estimator = nullptr;
  const SumAlgorithm* sum = nullptr;
  Precision precision = Precision::fp64;
  std::uint32_t coordinate_bits = 52;  // 23 also where coarse_coordinates
  LaunchShape shape;
  bool relaxed_math = false, counters = false, coarse_coordinates = false;  // as in PlanOptions
  bool device_fp64 = true;      // for what is summed in the widest precision, whatever the cell's
  bool shape_is_tuned = false;  // from DeviceFacts::tuning; else the device's default, or given
  ProgramSource program;
  PointRequest request;
  std::optional<PlannedPreparation> preparation;  // to run before the point table is built
  std::vector<std::uint64_t>
      refused_n;  // sizes of the study beyond the resolution; cell.n keeps the others
  std::uint64_t max_allocation = 0;      // bytes, of the device
  std::string fp_config32, fp_config64;  // as in DeviceFacts
  std::vector<LeftOut> left_out;

  bool fp64() const { return precision == Precision::fp64; }
  bool stores_doubles() const { return sum->needs_fp64 || fp64(); }
  // Randomizations that a launch of all estimates runs.
  std::uint32_t launched_replicates() const {
    return cell.replicates * estimator->replicates_per_estimate;
  }
  // Words per partial sum, of one moment and of all.
  std::uint32_t sum_words() const { return sum->words(fp64()); }
  std::uint32_t words() const { return sum_words() * estimator->moments; }
  // Stored word `word` of all moments counts 2^word_exponent times its value.
  int word_exponent(std::uint32_t word) const {
    return sum->word_exponent(fp64(), word % sum_words());
  }
};

// UnsupportedError when the device lacks what the cell asks for (fp64), or the sampler the
// resolution.
Plan make_plan(const Catalog& catalog, const Cell& cell, const DeviceFacts& device,
               const std::string& directions_file = "", const PlanOptions& options = {});

// The plan's program with counters: the plan's own where it has them, else built only when a
// partial sum came out non-finite.
ProgramSource counting_program(const Catalog& catalog, const Plan& plan);

// Dumps points; with an integrand (draw counting) when the plan's scene is given.
ProgramSource inspect_program(const Catalog& catalog, const Plan& plan, bool with_integrand);

// Exact values and coefficient set-up of a scene's integrand, for a CPU device with fp64.
ProgramSource exact_program(const Integrand& integrand, const Scene& scene);

// kernels/quality/<piece>.cl behind the prelude, for points of any dimension; `shape` gives the
// lanes per work-item and the local size.
ProgramSource quality_program(const std::string& piece, bool fp64, const LaunchShape& shape);

// kernels/calibrate.cl behind the prelude in fp32; `shape` as above.
ProgramSource calibration_program(const LaunchShape& shape);

// kernels/stability/<piece>.cl behind the prelude and these sums, each with the kernel add_up_<k>
// of add-up.cl, k its place among them. `options` come behind those that every program has.
ProgramSource self_test_program(const std::string& piece,
                                const std::vector<const SumAlgorithm*>& sums, Precision precision,
                                std::uint32_t lanes_per_item, const std::string& options);

// The point table in the words of the plan's precision, as bytes ready to upload (at least one
// word). Of sets that are not extensible it is that of the set of n points; 0: the plan's largest.
// `prepared`: what the plan's preparation computed, where it has one; device/prepare.hpp runs it
// and calls this.
std::vector<std::byte> build_point_table(
    const Plan& plan, std::uint64_t n = 0,
    const std::shared_ptr<const std::vector<double>>& prepared = nullptr);

// log2 of the block length for N samples: at least 2^8, so that seeking is cheap beside stepping;
// at most 2^16; 64 blocks in between. A function of N alone, so results do not depend on the
// device.
std::uint32_t log2_block_length(std::uint64_t n);

// A plan for dumping points only, without a scene.
Plan make_points_plan(const Catalog& catalog, const std::string& sampler, std::uint32_t dim,
                      Precision precision, std::uint64_t end_index, std::uint32_t replicates,
                      std::uint64_t seed, const DeviceFacts& device,
                      const std::string& directions_file = "",
                      const std::optional<LaunchShape>& shape = std::nullopt);

}  // namespace koksma
