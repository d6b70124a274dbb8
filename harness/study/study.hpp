// A study: the list of cells to run, from a JSON file, from flags, or both. Everything that can be
// checked without a device or a table is checked here, before anything is built or run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalog/catalog.hpp"

namespace koksma {

enum class Precision { fp32, fp64 };
std::string_view precision_name(Precision precision);  // "fp32", "fp64"

// One integration problem with everything fixed.
struct Scene {
  std::string integrand;
  std::uint32_t dim = 1;
  std::vector<double> parameters;    // in the order of the integrand's entry
  std::vector<std::string> choices;  // values, in the order of the entry
  std::string text;  // canonical spelling, NAME:d=D,key=value for what differs from the default
};

// When a cell stops before or after the sizes that were asked for. A rule that is set may also go
// beyond the largest of them, by doubling.
struct StopRule {
  std::optional<double> time_budget;      // seconds of wall time for all rows of the cell
  std::optional<double> until;            // RMSE relative to |I|, or absolute where I = 0
  std::optional<std::uint64_t> beyond_n;  // the largest N to go on to; empty: largest_size()

  bool any() const { return time_budget || until; }
};

// scene x sampler x estimator x precision, and the sizes N to run it at.
struct Cell {
  Scene scene;
  std::string sampler, estimator;
  std::optional<Precision> precision;  // empty: the device's best
  std::string sum;                     // empty: the best the device can run
  std::vector<std::uint64_t> n;        // ascending
  std::uint32_t replicates = 1;
  std::uint64_t seed = 0;
  StopRule stop;
  std::optional<std::uint32_t> launches;  // at most so many timed launches of a row, 1 to 16
};

struct Study {
  std::string title;
  std::uint64_t seed = 1;
  std::vector<Cell> cells;
  Json verbatim;  // the study as it was understood, flags merged in
};

// What the command line may set; empty members leave the study's value.
struct StudyFlags {
  std::vector<std::string> scenes, samplers;
  std::string estimator, n, precision, sum;
  std::optional<std::uint32_t> replicates, launches;
  std::optional<std::uint64_t> seed;
  std::optional<double> time_budget, until;
  bool own_directions = false;  // --directions: the file sets the limit on d
};

// "NAME" or "NAME:key=value,…"; values are numbers, fractions a/b, or one of a choice's; the key d
// is the dimension.
Scene parse_scene(const Catalog& catalog, std::string_view text, std::string_view where);

// The scene of an entry's check or case: `values` holds the parameters and choices that differ from
// their defaults; the catalog has checked their names.
Scene scene_of(const Integrand& f, std::uint32_t dim, const Json& values);

// "2^8..2^20" (every power of two between), "1000", "2^10", or a comma-separated list of these;
// ascending.
std::vector<std::uint64_t> parse_sizes(std::string_view text, std::string_view where);

// InputError, naming the nearest sizes, when the sampler has no set of n points in `dim`
// dimensions.
void check_size(const Sampler& sampler, std::uint32_t dim, std::uint64_t n,
                const std::string& where);

// The largest N that a cell with a stop rule may reach: beyond_n; without it, what the sampler has
// where a time budget ends the cell, else kBeyondStudy times the largest size asked for; never more
// than the sampler has. Without a rule, the largest size asked for.
std::uint64_t largest_size(const Sampler& sampler, const Cell& cell);

// With --until alone a curve that never gets there must end: 6 doublings beyond the study.
inline constexpr std::uint64_t kBeyondStudy = 64;

// The next size after n: of those asked for; beyond them, the smallest that the sampler has and
// that is at least 2 n. None above largest_size().
std::optional<std::uint64_t> next_size(const Sampler& sampler, const Cell& cell, std::uint64_t n);

// Reads a study: `path` empty means the default study. InputError names the file and the JSON
// pointer, or the flag.
Study read_study(const Catalog& catalog, const std::string& path, const StudyFlags& flags);

// The same of JSON that is there already; `file` is what errors name.
Study study_from(const Catalog& catalog, const Json& given, const std::string& file,
                 const StudyFlags& flags = {});

}  // namespace koksma
