#include "cli/command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "cli/verbs.hpp"
#include "error/error.hpp"
#include "report/build_info.hpp"

namespace koksma {
namespace {

std::string joined(int argc, char** argv) {
  std::string text = "koksma";
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const bool plain =
        !argument.empty() &&
        argument.find_first_of(" \t\n\"'$`\\*?;&|<>(){}[]#~!") == std::string_view::npos;
    text += plain ? fmt::format(" {}", argument) : fmt::format(" '{}'", argument);
  }
  return text;
}

// The option, of the chosen verb or verbs, that is nearest to an argument that none of them knows.
std::string nearest_option(const CLI::App& app, const std::string& argument) {
  std::vector<std::string> known;
  const auto chosen = app.get_subcommands();
  for (const CLI::App* verb : chosen)
    for (const CLI::Option* option : verb->get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  if (chosen.empty())
    for (const CLI::App* verb : app.get_subcommands({})) known.push_back(verb->get_name());
  return nearest_name(argument.substr(0, argument.find('=')), known);
}

// An argument that nothing takes says more than the option that is missing because of it.
std::string unknown_argument(const CLI::App& app) {
  const auto remaining = app.remaining(true);
  if (remaining.empty()) return "";
  const std::string& unknown = remaining.front();
  const std::string nearest = nearest_option(app, unknown);
  const char* kind = unknown.starts_with('-')        ? "flag"
                     : app.get_subcommands().empty() ? "verb"
                                                     : "argument";
  return fmt::format("unknown {} '{}'{}", kind, unknown,
                     nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
}

int parse_failure(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  const bool may_be_unknown = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                              dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const std::string unknown = may_be_unknown ? unknown_argument(app) : "";
  fmt::print(stderr, "koksma: {}\nSee koksma --help, or --help after a verb.\n",
             unknown.empty() ? error.what() : unknown);
  return kBadInput;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App app{
      "koksma: error against run time of Monte Carlo and quasi-Monte Carlo integration through "
      "OpenCL"};
  app.set_version_flag("--version", build_info().version);
  app.require_subcommand(1);
  Action action;
  add_run(app, action, joined(argc, argv));
  add_list(app, action);
  add_explain(app, action);
  add_points(app, action);
  add_study(app, action);
  add_compare(app, action);
  add_report(app, action);
  add_quality(app, action, joined(argc, argv));
  add_tune(app, action);
  add_stability(app, action, joined(argc, argv));
  try {
    app.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    return parse_failure(app, error);
  } catch (const InputError& error) {
    fmt::print(stderr, "koksma: {}\n", error.what());
    return kBadInput;
  } catch (const UnsupportedError& error) {  // a study has rows for it, one request has not
    fmt::print(stderr, "koksma: {}\n", error.what());
    return kBadInput;
  } catch (const NoDeviceError& error) {
    fmt::print(stderr, "koksma: {}\n", error.what());
    return kNoDevice;
  } catch (const std::exception& error) {
    fmt::print(stderr, "koksma: {}\n", error.what());
    return kCellFailed;
  }
}

}  // namespace koksma
