// What the tests share: the catalog, one device, points and sums of small cells.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "device/exact.hpp"
#include "device/integrator.hpp"
#include "device/points_dump.hpp"
#include "estimate/measure.hpp"
#include "plan/plan.hpp"
#include "study/study.hpp"

namespace koksma::test {

// The integrand x + 1/2.
inline constexpr const char* kIdentity = "linear-prod:d=1,scale=1,power=0";
// Arguments of a cheap cell: few samples of a product in two dimensions.
inline const std::string kCheap =
    "--scene linear-prod:d=2 --sampler sobol-owen --n 2^6 --replicates 4 ";
inline constexpr Precision kPrecisions[] = {Precision::fp32, Precision::fp64};

const Catalog& catalog();
// The default device (PoCL), opened once.
Device& device();

struct PointsSpec {
  std::string sampler;
  std::uint32_t dim = 1;
  Precision precision = Precision::fp64;
  std::uint64_t start = 0, count = 0;
  std::uint32_t replicate = 0, log2_block = 8;
  std::uint64_t seed = 1;
  std::uint32_t lanes_per_item = 16;
  std::uint64_t n =
      0;  // size of a set that is not extensible; 0: the smallest that holds the points
};
// [point][dimension]
std::vector<double> points(const PointsSpec& spec);

// Whether the sampler's entry declares this property.
bool has_property(const Sampler& sampler, std::string_view property);

// False for samplers that are nothing without a text of the user's, such as the path of a file.
bool complete(const Sampler& sampler);

std::vector<Precision> precisions(const Sampler& sampler);
// One of a deterministic sampler, four of a randomized one.
std::vector<std::uint32_t> some_replicates(const Sampler& sampler);
// The dimension of tests that need none in particular, so that they share programs: 5, or the
// nearest there is.
std::uint32_t usual_dim(const Sampler& sampler);
// One sampler for each kernel of points: others of the same text differ by their tables only.
std::vector<Sampler> samplers_by_kernel();
// A size near 2^14 at which all coordinates lie on the binary grid: whole powers of two, also per
// dimension.
std::uint64_t grid_size(const Sampler& sampler, std::uint32_t dim);

// The smallest N >= at_least that the sampler has in `dim` dimensions.
std::uint64_t admitted_size(const Sampler& sampler, std::uint32_t dim, std::uint64_t at_least);

// A cell of one size.
Cell cell(const std::string& scene, const std::string& sampler, std::uint64_t n,
          std::uint32_t replicates = 1, const std::string& estimator = "");

// The estimates of a cell of several sizes, as "2^8..2^16".
CellResult run_sizes(const std::string& scene, const std::string& sampler, const std::string& sizes,
                     std::uint32_t replicates, std::optional<Precision> precision = {});

// All partial sums of a cell under a launch shape, sorted by (word, replicate, block, lane) as the
// device stores them.
std::vector<double> partial_sums(const Cell& cell, const LaunchShape& shape);

// The output and exit status of the command with these arguments (stdout and stderr together).
struct CommandResult {
  int status = 0;
  std::string output;
};
CommandResult run_command(const std::string& arguments, const std::string& environment = "");

// A fresh folder that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string path(const std::string& name) const { return path_ + "/" + name; }
  std::string write(const std::string& name, const std::string& text) const;  // returns its path

 private:
  std::string path_;
};

// `koksma run` into a file of the folder; its results, checked against the schema.
struct RunResult {
  CommandResult command;
  Json results;
};
RunResult run_study(const TemporaryFolder& folder, const std::string& arguments,
                    const std::string& name = "r.json");

// While it lives, an environment variable has this value.
class EnvironmentSet {
 public:
  EnvironmentSet(const char* name, const std::string& value);
  ~EnvironmentSet();
  EnvironmentSet(const EnvironmentSet&) = delete;
  EnvironmentSet& operator=(const EnvironmentSet&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

// While it lives, the cache is in this folder. The device, whose driver keeps a cache by the same
// variable, is opened before.
class CacheAt {
 public:
  explicit CacheAt(const std::string& folder) : folder_("XDG_CACHE_HOME", (device(), folder)) {}

 private:
  EnvironmentSet folder_;
};

// The same, and programs and tunings are kept there by devices that are opened meanwhile (by
// default the tests keep none).
class KeepingOn {
 public:
  explicit KeepingOn(const std::string& folder) : cache_(folder), on_("KOKSMA_KEPT", "on") {}

 private:
  CacheAt cache_;
  EnvironmentSet on_;
};

// The text of a file of the repository.
std::string repository_file(const std::string& path);

// Five cells of the committed default study: of independent points, deterministic, scrambled.
const Json& recorded_study();

}  // namespace koksma::test
