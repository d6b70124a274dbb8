// Bad input: the exit status, and a message that says where, what was found and what is allowed,
// before anything is built.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;
using koksma::test::CommandResult;
using koksma::test::run_command;

namespace {

namespace fs = std::filesystem;

void check_refused(const std::string& arguments, int status, const std::vector<std::string>& parts,
                   const std::string& environment = "") {
  const CommandResult result = run_command(arguments, environment);
  INFO("koksma " << arguments << "\n" << result.output);
  CHECK(result.status == status);
  CHECK_THAT(result.output, Catch::StartsWith("koksma: "));
  for (const std::string& part : parts) CHECK_THAT(result.output, Contains(part));
  // Told before anything is built.
  CHECK_THAT(result.output, !Contains("building"));
}

}  // namespace

TEST_CASE(
    "bad studies and flags stop with status 2 before anything is built, and say what is wrong",
    "[device]") {
  const test::TemporaryFolder folder;
  const std::string out = " --out " + folder.path("r.json");
  const std::string malformed = folder.write("malformed.json", "{\n  \"cells\": [}\n");
  folder.write("malformed.cl", "");
  const std::string unknown_key = folder.write(
      "key.json",
      R"({"cells": [{"scenes": ["keister"], "samplers": ["sobol"], "replicatse": 3}]})");
  const std::string unknown_name = folder.write(
      "name.json", R"({"cells": [{"scenes": ["keister"], "samplers": ["sobol", "sobl-shift"]}]})");
  check_refused("run " + malformed + out, 2, {malformed, "malformed JSON", "line 2, column 13"});
  check_refused("run " + unknown_key + out, 2,
                {unknown_key, "at '/cells/0/replicatse'", "did you mean 'replicates'?"});
  check_refused("run " + unknown_name + out, 2,
                {unknown_name, "at '/cells/0/samplers/1'", "did you mean 'sobol-shift'?"});
  check_refused("run " + folder.path("none.json") + out, 2, {"none.json", "cannot be read"});
  check_refused("run " + folder.path("") + out, 2, {"cannot be read"});
  check_refused("run --scene linear-prod:d=2 --sampler sobl --n 2^6" + out, 2,
                {"--sampler: unknown sampler 'sobl'", "did you mean 'sobol'?"});
  check_refused("run --scene ishigami:d=4 --sampler sobol --n 2^6" + out, 2,
                {"--scene: d = 4 is out of range for 'ishigami'", "from 3 to 3"});
  check_refused("run --scene linear-prod:scale=1e9 --sampler sobol --n 2^6" + out, 2,
                {"--scene: scale = 1000000000 is out of range", "allowed: "});
  check_refused("run --scene keister --sampler lattice --n 1000" + out, 2,
                {"--n: N = 1000 for sampler 'lattice'", "512 and 1024"});
  check_refused("run --scene keister --sampler sobol --n 2^6 --estimator mc" + out, 2,
                {"--estimator: estimator 'mc' does not fit sampler 'sobol'", "these do: qmc"});
  check_refused("run --scene keister --sampler sobol-owen --n 2^6 --replicates 1" + out, 2,
                {"--replicates: 1 replicate"});
  check_refused("run " + test::kCheap + "--sum naiv" + out, 2,
                {"--sum: unknown sum 'naiv'", "did you mean 'naive'?"});
  check_refused("run --scene keister --sampler sobol --n 2^99" + out, 2, {"--n: '2^99'"});
  check_refused("run " + test::kCheap + "--integrand " + malformed + out, 2,
                {malformed, "line 2, column 13"});
  CHECK_FALSE(fs::exists(folder.path("r.json")));
}

TEST_CASE("a command line that is wrong gets status 2 and the nearest spelling", "[unit]") {
  check_refused("run --sampelr sobol", 2, {"--sampelr", "did you mean '--sampler'?"});
  check_refused("run --reps=3", 2, {"unknown flag '--reps=3'"});
  check_refused("explain --scen keister --sampler sobol", 2, {"--scen", "did you mean '--scene'?"});
  check_refused("rum", 2, {"unknown verb 'rum'", "did you mean 'run'?"});
  check_refused("polints --dim 3", 2, {"unknown verb 'polints'", "did you mean 'points'?"});
  check_refused("--sampler sobol", 2, {"--sampler"});
  check_refused("", 2, {"subcommand", "--help"});
  check_refused("run a.json b.json", 2, {"unknown argument 'b.json'"});
  check_refused("explain --scene keister", 2, {"--sampler", "required"});
  check_refused("list smaplers", 2, {"unknown kind 'smaplers'", "did you mean 'samplers'?"});
  check_refused("run --precision fp16", 2, {"--precision", "fp16", "fp32", "fp64"});
  for (const char* bad : {"0", "-1", "65537", "x", "2.5"})
    check_refused(std::string("run --replicates ") + bad, 2, {"--replicates"});
  for (const char* bad : {"-1", "x", "1.5", "9223372036854775808"})
    check_refused(std::string("run --seed ") + bad, 2, {"--seed"});
}

TEST_CASE("help and version are no errors", "[unit]") {
  for (const char* arguments :
       {"--help", "--version", "run --help", "list --help", "points --help", "explain --help"})
    CHECK(run_command(arguments).status == 0);
}

TEST_CASE("an output that cannot be written is told before anything is built, device or not",
          "[device]") {
  const test::TemporaryFolder folder;
  const std::string none = folder.path("none/r.json");
  for (const char* environment : {"", "OCL_ICD_VENDORS=/nonexistent/"}) {
    check_refused("run " + test::kCheap + "--out " + none, 2,
                  {none, "cannot write: No such file or directory"}, environment);
    check_refused("run " + test::kCheap + "--out " + folder.path(""), 2,
                  {"cannot write: it is a folder"}, environment);
    check_refused("points --sampler sobol --dim 2 --n 4 --out " + folder.path("none/p.csv"), 2,
                  {"none/p.csv", "cannot write"}, environment);
  }
  CHECK(fs::is_empty(folder.path("")));
}

TEST_CASE("without an OpenCL platform the status is 3 and the message says what to install",
          "[unit]") {
  const test::TemporaryFolder folder, vendors;
  const std::string environment = "OCL_ICD_VENDORS=" + vendors.path("") + " OCL_ICD_FILENAMES=";
  for (const std::string& arguments :
       {"run " + test::kCheap + "--out " + folder.path("r.json"), std::string("list devices"),
        std::string("explain --scene keister --sampler sobol"),
        "points --sampler sobol --dim 2 --n 4 --out " + folder.path("p.csv")})
    check_refused(arguments, 3, {"no OpenCL device", "pocl-opencl-icd"}, environment);
  // What needs no device works, and bad input stays bad input.
  CHECK(run_command("list samplers", environment).status == 0);
  check_refused("run --sampler sobl", 2, {"did you mean 'sobol'?"}, environment);
}

TEST_CASE("a device selector that matches nothing has status 3 and lists the devices there are",
          "[device]") {
  const test::TemporaryFolder folder;
  const Json devices = Json::parse(run_command("list devices --json").output);
  REQUIRE_FALSE(devices.empty());
  for (const char* selector : {"no-such-device", "99:0", "0:99"})
    check_refused(
        "run " + test::kCheap + "--device " + selector + " --out " + folder.path("r.json"), 3,
        {"--device: '" + std::string(selector) + "' matches no device",
         devices[0]["name"].get<std::string>() + "  " + devices[0]["title"].get<std::string>()});
  CHECK_FALSE(fs::exists(folder.path("r.json")));
  CHECK(run_command("run " + test::kCheap + "--quiet --device " +
                    devices[0]["name"].get<std::string>() + " --out " + folder.path("r.json"))
            .status == 0);
}

TEST_CASE("points that do not exist are refused with what does", "[unit]") {
  const test::TemporaryFolder folder;
  const std::string out = " --out " + folder.path("p.csv");
  check_refused("points --sampler sobl --dim 2 --n 4" + out, 2,
                {"--sampler: unknown sampler 'sobl'", "did you mean 'sobol'?"});
  check_refused("points --sampler sobol --dim 0 --n 4" + out, 2, {"--dim: 0", "1 to 3667"});
  check_refused("points --sampler sobol --dim 4000 --n 4" + out, 2, {"--dim: 4000", "1 to 3667"});
  check_refused("points --sampler sobol --dim 2 --n 2^4..2^6" + out, 2,
                {"--n", "one number of points"});
  check_refused("points --sampler lattice --dim 2 --n 2 --start 2^20" + out, 2, {"--start"});
  check_refused("points --sampler sobol --dim 2 --n 4 --start -1" + out, 2, {"--start"});
  check_refused("points --sampler sobol --dim 2 --n 4 --seed -1" + out, 2, {"--seed"});
  check_refused("points --sampler sobol --dim 2 --n 4 --replicate 1" + out, 2,
                {"--replicate: 1", "not randomized"});
  check_refused("points --sampler sobol --dim 2 --n 4 --out " + folder.path("p.txt"), 2,
                {"--out: ", "p.txt", ".csv or .npy"});
  const Sampler& lattice = test::catalog().sampler("lattice", "test");
  check_refused(fmt::format("points --sampler lattice --dim 2 --n 2 --start {}",
                            (1ULL << lattice.max_log2_n) - 1) +
                    out,
                2, {"sampler 'lattice' has 2^20 points"});
  CHECK(fs::is_empty(folder.path("")));
}
