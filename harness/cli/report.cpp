// koksma report: a results file in the format of another tool.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/verbs.hpp"
#include "journal/journal.hpp"
#include "report/compare.hpp"
#include "report/writers.hpp"

namespace koksma {
namespace {

struct ReportFlags {
  std::string results, out, format;
};

int report(const ReportFlags& flags) {
  // A wrong format is told before the file is read.
  if (const auto known = report_formats();
      std::find(known.begin(), known.end(), flags.format) == known.end())
    report_text({}, flags.format);
  const std::string text = report_text(read_results(flags.results), flags.format);
  if (flags.out == "-")
    fmt::print("{}", text);
  else
    write_file_atomically(flags.out, text);
  return kAllOk;
}

}  // namespace

void add_report(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ReportFlags>();
  CLI::App* verb = app.add_subcommand("report", "Write results in the format of another tool");
  verb->add_option("results", flags->results, "a results file")
      ->option_text("RESULTS.json")
      ->required();
  verb->add_option("--format", flags->format,
                   fmt::format("{}", fmt::join(report_formats(), " or ")))
      ->option_text("FORMAT");
  verb->add_option("-o,--out", flags->out, "where to write it, - for the terminal")
      ->option_text("FILE")
      ->required();
  verb->callback([flags, &action] { action = [flags] { return report(*flags); }; });
}

}  // namespace koksma
