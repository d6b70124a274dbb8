#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>

int main(int argc, char** argv) {
  // Programs are neither kept, which costs time, nor taken from a user's cache; nor is a tuning.
  setenv("KOKSMA_KEPT", "off", 1);
  Catch::Session session;
  // "[#file]" selects the tests of one file.
  session.configData().filenamesAsTags = true;
  const int status = session.applyCommandLine(argc, argv);
  return status != 0 ? status : session.run();
}
