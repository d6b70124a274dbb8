// koksma explain: the plan of one cell: what its kernel contains, uploads and stores, what was left
// out and why, what a coordinate costs; with --measure beside a general kernel.
#include <fmt/format.h>

#include <cmath>

#include "cli/verbs.hpp"
#include "device/compare_general.hpp"
#include "device/exact.hpp"
#include "device/operations.hpp"
#include "device/prepare.hpp"
#include "error/error.hpp"
#include "plan/general.hpp"
#include "plan/plan.hpp"
#include "plan/tuning.hpp"

namespace koksma {
namespace {

struct ExplainOptions {
  std::string device, directions;
  std::vector<std::string> integrands;
  StudyFlags flags;
  bool measure = false, json = false;
};

// What is known of a cell once it is planned, before any text.
struct Explained {
  const Plan& plan;
  const DeviceFacts& device;
  std::size_t table_bytes = 0;
  std::optional<std::size_t> full_table_bytes;  // with every column the sampler has
  std::size_t coefficient_bytes = 0;
  std::optional<OperationCount> operations;
  std::string no_operations;  // why they are not counted
  std::optional<GeneralComparison> measured;
  std::string not_measured;  // why there is nothing to compare with
};

std::uint32_t log2_block(const Plan& plan) {
  return plan.shape.log2_block.value_or(log2_block_length(plan.cell.n.back()));
}

void print_preparation(const Plan& plan) {
  if (!plan.preparation) return;
  const Preparation& work = plan.preparation->work;
  const std::string file = cache_file(*plan.preparation);
  fmt::print("preparation {}, {} points of {} dimensions, {} launches, kept in {}\n",
             plan.preparation->program.name, work.points, work.dim, work.launches.size(),
             file.empty() ? "memory: there is no cache folder" : file);
}

void print_head(const Explained& e) {
  const Plan& plan = e.plan;
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
      e.device.name, plan.shape.lanes_per_item, plan.shape.local_size, log2_block(plan),
      plan.cell.n.back());
  fmt::print("shape       {}\n",
             plan.shape_is_tuned ? fmt::format("tuned by koksma tune on {}", e.device.tuning->date)
                                 : "the device's default");
  print_preparation(plan);
}

void print_tables(const Explained& e) {
  const Plan& plan = e.plan;
  fmt::print(
      "draws       {} coordinates per sample\npoint table {} bytes, {:.1f} per dimension and "
      "{}\n",
      plan.request.dim, e.table_bytes,
      static_cast<double>(e.table_bytes) / plan.request.dim / plan.launched_replicates(),
      plan.estimator->replicates_per_estimate == 1 ? "replicate" : "randomization");
  if (e.full_table_bytes)
    fmt::print("full table  {} bytes, with every column the sampler has\n", *e.full_table_bytes);
  fmt::print("coefficient table {} bytes\nbuild options {}\n", e.coefficient_bytes,
             plan.program.options);
}

void print_operations(const Explained& e) {
  if (!e.operations) {
    fmt::print("\noperations  not counted: {}\n", e.no_operations);
    return;
  }
  fmt::print("\noperations per coordinate, counted while {} samples ran ({} lanes at a time)\n{}",
             e.operations->samples, e.operations->lanes, operations_table(*e.operations));
}

void print_measured(const Explained& e) {
  if (!e.measured) {
    fmt::print("\nmeasured    nothing: {}\n", e.not_measured);
    return;
  }
  const GeneralComparison& m = *e.measured;
  const std::uint64_t n = e.plan.cell.n.back();
  fmt::print(
      "\nmeasured at N = {}, {} replicates, the fastest of {} rounds{}\n  as planned  {:.6g} s, "
      "table {} bytes, estimate {:.17g}\n  general     {:.6g} s, table {} bytes, estimate "
      "{:.17g}\n  ratio       {:.3f}, estimates differ by {:.3g}, {:.3g} is rounding\n",
      n, e.plan.launched_replicates(), m.rounds,
      m.settled ? "" : ", which still differ by more than 2 %: the machine is busy", m.planned_s,
      m.planned_table, m.planned, m.general_s, m.general_table, m.general, m.ratio(),
      std::abs(m.planned - m.general), m.allowed);
}

void print_text(const Explained& e) {
  print_head(e);
  print_tables(e);
  print_operations(e);
  print_measured(e);
  fmt::print("\nleft out\n");
  for (const LeftOut& item : e.plan.left_out) fmt::print("  {}: {}\n", item.what, item.why);
  if (e.plan.preparation)
    fmt::print("\nsource of the preparation\n{}", e.plan.preparation->program.text);
  fmt::print("\nkernel source\n{}", e.plan.program.text);
}

Json measured_json(const Explained& e) {
  if (!e.measured) return {{"reason", e.not_measured}};
  const GeneralComparison& m = *e.measured;
  const auto finite = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  return {{"n", e.plan.cell.n.back()},
          {"rounds", m.rounds},
          {"settled", m.settled},
          {"ratio", m.ratio()},
          {"allowed_difference", finite(m.allowed)},
          {"planned",
           {{"kernel_s", m.planned_s},
            {"table_bytes", m.planned_table},
            {"estimate", finite(m.planned)}}},
          {"general",
           {{"kernel_s", m.general_s},
            {"table_bytes", m.general_table},
            {"estimate", finite(m.general)}}}};
}

// Everything but the kernel's text.
Json as_json(const Explained& e) {
  const Plan& plan = e.plan;
  Json left_out = Json::array();
  for (const LeftOut& item : plan.left_out)
    left_out.push_back({{"what", item.what}, {"why", item.why}});
  Json json = {{"scene", plan.cell.scene.text},
               {"sampler", plan.sampler->name},
               {"estimator", plan.estimator->name},
               {"replicates", plan.cell.replicates},
               {"randomizations", plan.launched_replicates()},
               {"precision", precision_name(plan.precision)},
               {"coordinate_bits", plan.coordinate_bits},
               {"centred", plan.sampler->centred},
               {"sum", plan.sum->name},
               {"words", plan.sum_words()},
               {"moments", plan.estimator->moments},
               {"device", e.device.name},
               {"lanes_per_item", plan.shape.lanes_per_item},
               {"local_size", plan.shape.local_size},
               {"log2_block", log2_block(plan)},
               {"n", plan.cell.n},
               {"coordinates", plan.request.dim},
               {"table_bytes", e.table_bytes},
               {"full_table_bytes", nullptr},
               {"coefficient_bytes", e.coefficient_bytes},
               {"build_options", plan.program.options},
               {"source_bytes", plan.program.text.size()},
               {"left_out", left_out}};
  if (e.full_table_bytes) json["full_table_bytes"] = *e.full_table_bytes;
  json["operations"] =
      e.operations ? operations_json(*e.operations) : Json{{"reason", e.no_operations}};
  json["measured"] = measured_json(e);
  return json;
}

void count(Explained& e, Device& device, const Catalog& catalog,
           const std::vector<double>& coefficients) {
  try {
    e.operations = count_operations(device, catalog, e.plan, coefficients);
  } catch (const UnsupportedError& error) {
    e.no_operations = error.what();
  }
}

void measure(Explained& e, Device& device, const Catalog& catalog,
             const std::vector<double>& coefficients, bool asked) {
  if (const auto none = no_general_kernel(e.plan)) {
    e.not_measured = *none;
    return;
  }
  e.not_measured = "ask for it with --measure";
  try {
    e.full_table_bytes = general_table(general_plan(catalog, e.plan)).size();
    if (asked)
      e.measured =
          compare_with_general(device, catalog, e.plan, coefficients, e.plan.cell.n.back());
  } catch (const UnsupportedError& error) {
    e.not_measured = error.what();
  }
}

int explain(const ExplainOptions& options) {
  std::future<Device> loading = Device::choose_beside(options.device);
  const Catalog catalog = load_catalog(options.integrands);
  StudyFlags flags = options.flags;
  flags.own_directions = !options.directions.empty();
  const Study study = read_study(catalog, "", flags);
  Device device = loading.get();
  Device exact_device = Device::choose_exact(device);
  for (const Cell& cell : study.cells) {
    Plan plan = make_plan(catalog, cell, device.facts(), options.directions);
    const ExactValues exact = compute_exact(exact_device, *plan.integrand, plan.cell.scene);
    plan.request.dimension_order = exact.dimension_order;
    Explained e{plan, device.facts(), point_table(device, plan).size(), {}, 0, {}, {}, {}, {}};
    e.coefficient_bytes = exact.coefficients.size() * (plan.fp64() ? 8 : 4);
    count(e, device, catalog, exact.coefficients);
    measure(e, device, catalog, exact.coefficients, options.measure);
    if (options.json)
      fmt::print("{}\n", as_json(e).dump(2));
    else
      print_text(e);
  }
  return kAllOk;
}

}  // namespace

void add_explain(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* verb = app.add_subcommand(
      "explain",
      "The plan of a cell: kernel source, tables, bytes, operations per coordinate, "
      "what was left out and why");
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
  verb->add_flag("--measure", options->measure,
                 "times the kernel, at the largest N, beside one that leaves nothing out");
  verb->add_flag("--json", options->json, "all of it but the kernel's text, as JSON");
  verb->callback([options, &action] { action = [options] { return explain(*options); }; });
}

}  // namespace koksma
