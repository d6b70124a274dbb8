#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

int main(int argc, char** argv) {
  Catch::Session session;
  // "[#file]" selects the tests of one file.
  session.configData().filenamesAsTags = true;
  const int status = session.applyCommandLine(argc, argv);
  return status != 0 ? status : session.run();
}
