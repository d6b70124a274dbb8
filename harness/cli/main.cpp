#include "cli/command.hpp"

int main(int argc, char** argv) { return koksma::run_command_line(argc, argv); }
