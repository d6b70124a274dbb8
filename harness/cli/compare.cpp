// koksma compare: two results files -> what changed beyond noise; exit status 1 on a regression.
#include <fmt/format.h>

#include "cli/verbs.hpp"
#include "journal/journal.hpp"
#include "report/compare_report.hpp"

namespace koksma {
namespace {

constexpr const char* kTerminal = "-";

struct CompareFlags {
  std::string base, now, markdown, json;
  double threshold_percent = 15;
  bool across_devices = false;
};

// Writes to the file, or to the terminal where none was given.
void give(const std::string& path, const std::string& text) {
  if (path == kTerminal)
    fmt::print("{}", text);
  else
    write_file_atomically(path, text);
}

int compare(const CompareFlags& flags) {
  CompareOptions options;
  options.threshold = flags.threshold_percent / 100;
  options.across_devices = flags.across_devices;
  const Comparison comparison =
      compare_results(read_results(flags.base), read_results(flags.now), options);
  if (!flags.markdown.empty()) give(flags.markdown, compare_markdown(comparison));
  if (!flags.json.empty()) give(flags.json, dumped(compare_json(comparison), 1) + "\n");
  // One thing on the terminal: what another program may read.
  if (flags.markdown != kTerminal && flags.json != kTerminal)
    fmt::print("{}", compare_table(comparison));
  return comparison.regression() ? kCellFailed : kAllOk;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  auto flags = std::make_shared<CompareFlags>();
  CLI::App* verb = app.add_subcommand(
      "compare",
      "What changed between two results files, beyond noise; exit status 1 on a regression");
  verb->add_option("base", flags->base, "results to compare with")
      ->option_text("BASE.json")
      ->required();
  verb->add_option("new", flags->now, "results of the same study")
      ->option_text("NEW.json")
      ->required();
  verb->add_option("--threshold", flags->threshold_percent,
                   "a time changed by less, in percent, is no change; default: 15")
      ->option_text("PERCENT")
      ->check(CLI::Range(0.1, 1000.0));
  verb->add_option("--markdown", flags->markdown,
                   "Markdown, into the file or in place of the table; behind the two files")
      ->option_text("[FILE]")
      ->expected(0, 1)
      ->default_str(kTerminal);
  verb->add_option("--json", flags->json,
                   "JSON after results/compare.schema.json, into the file or in place of the table")
      ->option_text("[FILE]")
      ->expected(0, 1)
      ->default_str(kTerminal);
  verb->add_flag("--across-devices", flags->across_devices,
                 "compare times although the devices differ");
  verb->callback([flags, &action] { action = [flags] { return compare(*flags); }; });
}

}  // namespace koksma
