// The verbs of the command line, one file each. A verb adds its options to the application and,
// when it is the one that was asked for, sets the action to run after parsing; the action returns
// the exit status.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>

namespace koksma {

using Action = std::function<int()>;

// Exit statuses (1-product).
inline constexpr int kAllOk = 0, kCellFailed = 1, kBadInput = 2, kNoDevice = 3;

// Seeds fit JSON's signed 64-bit integers, which the results' validator uses.
inline constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 63) - 1;

void add_run(CLI::App& app, Action& action, const std::string& command_line);
void add_list(CLI::App& app, Action& action);
void add_explain(CLI::App& app, Action& action);
void add_points(CLI::App& app, Action& action);
void add_study(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_tune(CLI::App& app, Action& action);
void add_quality(CLI::App& app, Action& action, const std::string& command_line);
void add_stability(CLI::App& app, Action& action, const std::string& command_line);

}  // namespace koksma
