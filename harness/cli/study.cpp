// koksma study: writes a ready study file, to run as it is or to start from.
#include <fmt/format.h>

#include <filesystem>

#include "cli/verbs.hpp"
#include "error/error.hpp"
#include "journal/journal.hpp"
#include "study/templates.hpp"

namespace koksma {
namespace {

struct StudyOptions {
  std::string name, out;
  bool force = false;
};

int list_studies() {
  std::size_t width = 0;
  for (const StudyTemplate& each : study_templates()) width = std::max(width, each.name.size());
  for (const StudyTemplate& each : study_templates())
    fmt::print("{:<{}}  {}\n", each.name, width, each.title);
  return kAllOk;
}

int write_study(const StudyOptions& options) {
  if (options.name.empty()) return list_studies();
  const Json study = ready_study(load_catalog(), options.name);
  const std::string text = study.dump(2) + "\n";
  const std::string out = options.out.empty() ? options.name + ".json" : options.out;
  if (out == "-") {
    fmt::print("{}", text);
    return kAllOk;
  }
  if (std::filesystem::exists(out) && !options.force)
    throw InputError(options.out.empty() ? "koksma study" : "--out",
                     fmt::format("{} exists already", out),
                     "give another name with --out, or --force to write over it");
  write_file_atomically(out, text);
  std::size_t cells = 0;
  for (const Json& block : study["cells"])
    cells += block["scenes"].size() * block["samplers"].size();
  fmt::print("{}: {} cells; run it with koksma run {}\n", out, cells, out);
  return kAllOk;
}

}  // namespace

void add_study(CLI::App& app, Action& action) {
  auto options = std::make_shared<StudyOptions>();
  CLI::App* verb = app.add_subcommand(
      "study", "Write a ready study file; without a name, list the studies that there are");
  verb->add_option("name", options->name, "a study of that list")->option_text("NAME");
  verb->add_option("--out", options->out,
                   "where to write it, - for the terminal; default: NAME.json")
      ->option_text("FILE.json");
  verb->add_flag("--force", options->force, "write over a file that exists");
  verb->callback([options, &action] { action = [options] { return write_study(*options); }; });
}

}  // namespace koksma
