// koksma quality: discrepancies, distances, spectra and the net parameter of points, as a table or
// as JSON, and as a picture.
#include <fmt/format.h>

#include <algorithm>

#include "cli/verbs.hpp"
#include "device/points_dump.hpp"
#include "error/error.hpp"
#include "journal/journal.hpp"
#include "quality/picture.hpp"
#include "report/quality_report.hpp"

namespace koksma {
namespace {

struct QualityOptions {
  std::string sampler, n, precision, out, picture, device, directions;
  std::uint32_t dim = 0;
  std::optional<std::uint32_t> replicates;
  std::uint64_t seed = 1;
  std::vector<std::string> scenes, integrands;
  bool json = false;
};

constexpr std::uint64_t kMostCoordinates = std::uint64_t{1} << 28;
constexpr std::uint32_t kDefaultReplicates = 16;  // sets that spectra are averaged over

std::uint64_t checked_size(const QualityOptions& options, const Sampler& sampler) {
  if (options.dim < sampler.min_dim ||
      (options.dim > sampler.max_dim && (options.directions.empty() || !sampler.reads_directions)))
    throw InputError("--dim", fmt::format("{}", options.dim),
                     fmt::format("sampler '{}' has {} to {} dimensions", sampler.name,
                                 sampler.min_dim, sampler.max_dim));
  const auto sizes = parse_sizes(options.n, "--n");
  if (sizes.size() != 1)
    throw InputError("--n", fmt::format("'{}'", options.n), "give one number of points");
  const std::uint64_t n = sizes[0];
  if (n > std::uint64_t{1} << sampler.max_log2_n)
    throw InputError("--n", fmt::format("{}", n),
                     fmt::format("sampler '{}' has 2^{} points", sampler.name, sampler.max_log2_n));
  check_size(sampler, options.dim, n, "--n");
  return n;
}

std::uint32_t checked_replicates(const QualityOptions& options, const Sampler& sampler) {
  if (options.replicates.value_or(1) > 1 && !sampler.replicable)
    throw InputError("--replicates", fmt::format("{}", *options.replicates),
                     fmt::format("sampler '{}' is not randomized: only 1", sampler.name));
  if (options.replicates.value_or(1) > 1 && options.dim != 2)
    throw InputError("--replicates", fmt::format("{}", *options.replicates),
                     fmt::format("d = {}: only in the plane are there averages", options.dim));
  // Only planar points have spectra to average, and moving a set about leaves them as they are.
  const bool averages = sampler.replicable && !sampler.rotated && options.dim == 2;
  return options.replicates.value_or(averages ? kDefaultReplicates : 1);
}

std::vector<Scene> checked_scenes(const QualityOptions& options, const Catalog& catalog) {
  std::vector<Scene> scenes;
  for (const std::string& text : options.scenes) {
    scenes.push_back(parse_scene(catalog, text, "--scene"));
    if (scenes.back().dim != options.dim)
      throw InputError("--scene",
                       fmt::format("'{}' has d = {}", scenes.back().text, scenes.back().dim),
                       fmt::format("the points have --dim {0}: write d={0}", options.dim));
  }
  return scenes;
}

// Everything wrong with the request is told before anything is built or run.
struct CheckedRequest {
  Sampler sampler;
  QualityRequest request;
  std::vector<Scene> scenes;
};

CheckedRequest check(const QualityOptions& options, const Catalog& catalog,
                     const std::string& command_line) {
  const Sampler sampler = catalog.sampler(options.sampler, "--sampler");
  CheckedRequest checked{sampler, {}, checked_scenes(options, catalog)};
  QualityRequest& request = checked.request;
  request.sampler = sampler.name;
  request.dim = options.dim;
  request.n = checked_size(options, sampler);
  request.replicates = checked_replicates(options, sampler);
  if (request.n > kMostCoordinates / options.dim / request.replicates)
    throw InputError("--n, --dim, --replicates",
                     fmt::format("{} points in {} dimensions, {} sets", request.n, options.dim,
                                 request.replicates),
                     fmt::format("at most {} coordinates in all", kMostCoordinates));
  request.seed = options.seed;
  request.directions = options.directions;
  request.command = command_line;
  for (const Scene& scene : checked.scenes) request.scenes.push_back(scene.text);
  if (!options.picture.empty() && !options.picture.ends_with(".png"))
    throw InputError("--picture", fmt::format("'{}'", options.picture),
                     "the name must end in .png");
  for (const std::string& path : {options.out, options.picture})
    if (!path.empty()) check_writable(path);
  return checked;
}

std::vector<PointSet> draw_sets(Device& device, const Plan& plan, const QualityRequest& request) {
  PointsDump dump(device, plan);
  std::vector<PointSet> sets;
  for (std::uint32_t r = 0; r < request.replicates; ++r)
    sets.push_back({request.dim, dump.read(0, request.n, request.n, r)});
  return sets;
}

std::vector<KoksmaHlawka> inequalities(const CheckedRequest& checked, const Catalog& catalog,
                                       Device& device, Precision precision,
                                       const Quality& quality) {
  // The estimator that any points have: the plain mean.
  const auto plain =
      std::find_if(catalog.estimators.begin(), catalog.estimators.end(),
                   [](const Estimator& e) { return e.fits.empty() && !e.replicated; });
  std::vector<KoksmaHlawka> result;
  for (const Scene& scene : checked.scenes) {
    Cell cell;
    cell.scene = scene;
    cell.sampler = checked.sampler.name;
    cell.estimator = plain->name;
    cell.precision = precision;
    cell.n = {checked.request.n};
    cell.seed = checked.request.seed;
    result.push_back(koksma_hlawka(catalog, device, cell, quality, checked.request.directions));
  }
  return result;
}

int quality(const QualityOptions& options, const std::string& command_line) {
  std::future<Device> loading = Device::choose_beside(options.device);
  const Catalog catalog = load_catalog(options.integrands);
  CheckedRequest checked = check(options, catalog, command_line);
  QualityRequest& request = checked.request;
  Device device = loading.get();
  const bool fp64 = device.facts().fp64;
  request.precision = options.precision.empty() ? (fp64 ? "fp64" : "fp32") : options.precision;
  const Precision precision = request.precision == "fp64" ? Precision::fp64 : Precision::fp32;
  const Plan plan =
      make_points_plan(catalog, request.sampler, request.dim, precision, request.n,
                       request.replicates, request.seed, device.facts(), request.directions);
  const std::vector<PointSet> sets = draw_sets(device, plan, request);
  QualityKernels kernels(device, fp64);
  const Quality measured = measure_quality(kernels, sets);
  const Json json = quality_json(request, plan, device.facts(), fp64, measured,
                                 inequalities(checked, catalog, device, precision, measured));
  if (!options.out.empty()) write_file_atomically(options.out, dumped(json, 1) + "\n");
  if (!options.picture.empty()) {
    const std::string title =
        fmt::format("{}   d = {}   N = {}", request.sampler, request.dim, request.n);
    write_file_atomically(options.picture, draw_quality(sets.front(), measured, title).png());
  }
  if (options.json)
    fmt::print("{}\n", dumped(json, 1));
  else
    fmt::print("{}", quality_table(json));
  return kAllOk;
}

}  // namespace

void add_quality(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<QualityOptions>();
  CLI::App* verb = app.add_subcommand(
      "quality", "Discrepancies, distances, spectra and net parameter of points");
  verb->add_option("--sampler", options->sampler, "a sampler (see koksma list samplers)")
      ->required();
  verb->add_option("--dim", options->dim, "dimensions")->required();
  verb->add_option("--n", options->n, "number of points: 1000 or 2^10")->required();
  verb->add_option(
          "--replicates", options->replicates,
          "randomizations that spectra and pair correlations are averaged over; default: 16 "
          "in the plane, else 1")
      ->check(CLI::Range(1, 1024));
  verb->add_option("--seed", options->seed, "seed of the randomization; default 1")
      ->check(CLI::Range(std::uint64_t{0}, kLargestSeed));
  verb->add_option("--precision", options->precision,
                   "of the points: fp32 or fp64; default: fp64 where the device has it")
      ->check(CLI::IsMember({"fp32", "fp64"}));
  verb->add_option("--scene", options->scenes,
                   "NAME:d=D of the same dimension: its Koksma-Hlawka bound; repeatable")
      ->allow_extra_args(false);
  verb->add_option("--integrand", options->integrands, "an integrand of your own; repeatable")
      ->allow_extra_args(false);
  verb->add_option("--device", options->device, "P:D or part of a name");
  verb->add_option("--directions", options->directions,
                   "Sobol' direction numbers in Joe and Kuo's format");
  verb->add_flag("--json", options->json, "JSON instead of the table");
  verb->add_option("--out", options->out, "F.json: the JSON into a file");
  verb->add_option("--picture", options->picture,
                   "F.png: points, and their spectrum or projections");
  verb->callback([options, command_line, &action] {
    action = [options, command_line] { return quality(*options, command_line); };
  });
}

}  // namespace koksma
