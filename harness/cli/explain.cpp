// koksma explain: the plan of one cell: what its kernel contains, uploads and stores, and what was
// left out and why.
#include <fmt/format.h>

#include <algorithm>

#include "cli/verbs.hpp"
#include "device/exact.hpp"
#include "device/prepare.hpp"
#include "error/error.hpp"
#include "plan/tuning.hpp"

namespace koksma {
namespace {

struct ExplainOptions {
  std::string device, directions;
  std::vector<std::string> integrands;
  StudyFlags flags;
};

void print_preparation(const Plan& plan) {
  if (!plan.preparation) return;
  const Preparation& work = plan.preparation->work;
  const std::string file = cache_file(*plan.preparation);
  fmt::print("preparation {}, {} points of {} dimensions, {} launches, kept in {}\n",
             plan.preparation->program.name, work.points, work.dim, work.launches.size(),
             file.empty() ? "memory: there is no cache folder" : file);
}

void print_plan(const Plan& plan, std::size_t table_bytes, const DeviceFacts& device) {
  const std::size_t size = plan.fp64() ? 8 : 4;
  const std::uint32_t each = plan.estimator->replicates_per_estimate;
  fmt::print("scene       {}\nsampler     {} ({})\nestimator   {}, {} replicate{}{}\n",
             plan.cell.scene.text, plan.sampler->name, plan.sampler->title, plan.estimator->name,
             plan.cell.replicates, plan.cell.replicates == 1 ? "" : "s",
             each == 1 ? ""
                       : fmt::format(": medians of {} randomizations, {} in all", each,
                                     plan.launched_replicates()));
  fmt::print(
      "precision   {}, coordinates of {} bits in {}\nsum         {}, {} word{} per partial sum, "
      "moments: {}\n",
      precision_name(plan.precision), plan.coordinate_bits,
      plan.sampler->centred ? "(0,1), centred" : "[0,1), exact", plan.sum->name, plan.sum_words(),
      plan.sum_words() == 1 ? "" : "s", plan.estimator->moments);
  fmt::print(
      "device      {}\nkernel      {} lanes per work-item, local size {}, blocks of 2^{} samples "
      "at N = {}\n",
      device.name, plan.shape.lanes_per_item, plan.shape.local_size,
      plan.shape.log2_block.value_or(log2_block_length(plan.cell.n.back())), plan.cell.n.back());
  fmt::print("shape       {}\n",
             plan.shape_is_tuned ? fmt::format("tuned by koksma tune on {}", device.tuning->date)
                                 : "the device's default");
  print_preparation(plan);
  fmt::print(
      "draws       {} coordinates per sample\npoint table {} bytes, {:.1f} per dimension and "
      "{}\n",
      plan.request.dim, table_bytes,
      static_cast<double>(table_bytes) / plan.request.dim / plan.launched_replicates(),
      each == 1 ? "replicate" : "randomization");
  fmt::print("coefficient table {} bytes\nbuild options {}\n\nleft out\n",
             plan.integrand->coefficients.size() * plan.cell.scene.dim * size,
             plan.program.options);
  for (const LeftOut& item : plan.left_out) fmt::print("  {}: {}\n", item.what, item.why);
  if (plan.preparation)
    fmt::print("\nsource of the preparation\n{}", plan.preparation->program.text);
  fmt::print("\nkernel source\n{}", plan.program.text);
}

int explain(const ExplainOptions& options) {
  const Catalog catalog = load_catalog(options.integrands);
  StudyFlags flags = options.flags;
  flags.own_directions = !options.directions.empty();
  const Study study = read_study(catalog, "", flags);
  Device device = Device::choose(options.device);
  for (const Cell& cell : study.cells) {
    const Plan plan = make_plan(catalog, cell, device.facts(), options.directions);
    print_plan(plan, point_table(device, plan).size(), device.facts());
  }
  return kAllOk;
}

}  // namespace

void add_explain(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* verb = app.add_subcommand(
      "explain", "The plan of a cell: kernel source, tables, bytes, what was left out and why");
  verb->add_option("--scene", options->flags.scenes, "NAME or NAME:d=8,key=value")
      ->required()
      ->expected(1);
  verb->add_option("--sampler", options->flags.samplers, "a sampler")->required()->expected(1);
  verb->add_option("--estimator", options->flags.estimator,
                   "mc, qmc or rqmc; default: what fits the sampler");
  verb->add_option("--n", options->flags.n, "sample counts");
  verb->add_option("--replicates", options->flags.replicates, "independent randomizations per N")
      ->check(CLI::Range(1, 65536));
  verb->add_option("--precision", options->flags.precision, "fp32 or fp64")
      ->check(CLI::IsMember({"fp32", "fp64"}));
  verb->add_option("--sum", options->flags.sum, "summation algorithm");
  verb->add_option("--device", options->device, "P:D or part of a name");
  verb->add_option("--integrand", options->integrands, "an integrand of your own; repeatable")
      ->allow_extra_args(false);
  verb->add_option("--directions", options->directions,
                   "Sobol' direction numbers in Joe and Kuo's format");
  verb->callback([options, &action] { action = [options] { return explain(*options); }; });
}

}  // namespace koksma
