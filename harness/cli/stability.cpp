// koksma stability: checks of the device -> cases -> verdicts against what they must be.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "cli/verbs.hpp"
#include "error/error.hpp"
#include "journal/journal.hpp"
#include "report/results.hpp"
#include "report/stability_report.hpp"
#include "report/table.hpp"

namespace koksma {
namespace {

struct StabilityOptions {
  std::vector<std::string> scenes, integrands;
  std::string device, out;
  bool fast_math = false, quiet = false;
};

std::string progress_line(const CaseOutcome& outcome) {
  return fmt::format(
      "{} with {}: {}", outcome.cell["scene"]["text"].get<std::string>(),
      outcome.cell["sampler"].get<std::string>(),
      outcome.verdict.empty() ? outcome.cell["status"].get<std::string>() : outcome.verdict);
}

int stability(const StabilityOptions& options, const std::string& command_line) {
  const auto start = std::chrono::steady_clock::now();
  std::future<Device> loading = Device::choose_beside(options.device);
  const Catalog catalog = load_catalog(options.integrands);
  std::vector<std::string> scenes = options.scenes;
  if (scenes.empty())
    for (const Integrand& f : catalog.integrands)
      if (f.users_own) scenes.push_back(f.name);
  const Suite suite = scenes.empty() ? full_suite(catalog) : suite_of(catalog, scenes);
  std::string out = options.out;
  if (out.empty()) {
    out = "results/latest-stability.json";
    std::error_code ignored;
    std::filesystem::create_directories("results", ignored);
  }
  check_writable(out);
  Device device = loading.get();
  Device exact_device = Device::choose_exact(device);

  Progress progress(stderr, suite.study.cells.size(), options.quiet);
  progress.stage("checks of the device");
  const DeviceChecks checks = run_device_checks(catalog, device);
  SuiteOptions suite_options;
  suite_options.checks = &checks;
  suite_options.fast_math = options.fast_math;
  suite_options.progress = [&](std::size_t, const CaseOutcome& outcome) {
    progress.finished(progress_line(outcome));
  };
  const auto outcomes = run_suite(catalog, device, exact_device, suite, suite_options);
  progress.clear();

  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Json json = stability_json(make_context(device.facts(), suite.study, command_line), checks,
                                   outcomes, seconds);
  write_file_atomically(out, dumped(json, 1) + "\n");
  if (!options.quiet) fmt::print("{}results: {}\n", stability_table(json), out);
  return all_met(json) ? kAllOk : kCellFailed;
}

}  // namespace

void add_stability(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<StabilityOptions>();
  CLI::App* verb = app.add_subcommand(
      "stability",
      "What breaks on stiff and extreme cases, why, and how small the error can get; exit status 1 "
      "if a case does not get the verdict it must");
  verb->add_option("--scene", options->scenes,
                   "NAME: its cases, and three usual cells; NAME:d=8,key=value: that scene; "
                   "repeatable; default: the whole suite")
      ->allow_extra_args(false);
  verb->add_flag("--fast-math", options->fast_math,
                 "also run every case under relaxed math, and say what that changes");
  verb->add_option(
          "--integrand", options->integrands,
          "an integrand of your own: F.json with F.cl beside it; repeatable; without --scene, "
          "its cases and three usual cells")
      ->allow_extra_args(false);
  verb->add_option("--device", options->device,
                   "P:D or part of a name (see koksma list devices); default: PoCL");
  verb->add_option("--out", options->out, "results file; default: results/latest-stability.json")
      ->option_text("FILE.json");
  verb->add_flag("--quiet", options->quiet, "no table and no progress");
  verb->callback([options, &action, command_line] {
    action = [options, command_line] { return stability(*options, command_line); };
  });
}

}  // namespace koksma
