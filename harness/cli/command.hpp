// koksma, the command: parse, run the verb, turn errors into messages and exit statuses.
#pragma once

namespace koksma {

// The exit status (cli/verbs.hpp) of the command line that main() was given; prints its own errors.
int run_command_line(int argc, char** argv);

}  // namespace koksma
