// The comparison with peers and the linear cost: the scripts parse and do their own arithmetic
// right, and what is committed follows the schemas and says of itself what its numbers say.
#include <sys/wait.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support.hpp"

using namespace koksma;

namespace {

namespace fs = std::filesystem;

const std::string kRoot = KOKSMA_SOURCE_DIR;

// Output and exit status of python3 with these arguments, in the repository.
test::CommandResult python(const std::string& arguments) {
  const std::string line =
      "cd '" + kRoot + "' && PYTHONDONTWRITEBYTECODE=1 python3 " + arguments + " 2>&1 </dev/null";
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("popen failed");
  test::CommandResult result;
  std::array<char, 4096> buffer{};
  while (const std::size_t got = fread(buffer.data(), 1, buffer.size(), pipe))
    result.output.append(buffer.data(), got);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return result;
}

Json results_file(const std::string& name) {
  return parse_json(test::repository_file("results/" + name), name);
}

}  // namespace

TEST_CASE("every script in Python compiles", "[unit]") {
  std::string files;
  std::size_t count = 0;
  for (const auto& file : fs::recursive_directory_iterator(kRoot + "/scripts"))
    if (file.path().extension() == ".py") {
      files += " '" + file.path().string() + "'";
      ++count;
    }
  CHECK(count >= 10);
  const auto run = python(
      "-c 'import sys; [compile(open(f).read(), f, \"exec\") for f in sys.argv[1:]]'" + files);
  INFO(run.output);
  CHECK(run.status == 0);
}

TEST_CASE("times to tolerances, ratios and rounds of the comparison are right on synthetic times",
          "[unit]") {
  const auto run = python("scripts/peers/self_test.py");
  INFO(run.output);
  CHECK(run.status == 0);
}

TEST_CASE("the committed comparison and cost follow their schemas", "[unit]") {
  CHECK_NOTHROW(
      check_schema(results_file("peers.json"), "results/peers.schema.json", "peers.json"));
  for (const char* curves : {"linear-cost.json", "linear-cost-fp64.json"})
    CHECK_NOTHROW(check_schema(results_file(curves), "results/linear-cost.schema.json", curves));
}

TEST_CASE("every headline of the committed comparison is met exactly where its ratio is as asked",
          "[unit]") {
  const Json document = results_file("peers.json");
  REQUIRE(!document["headlines"].empty());
  for (const Json& row : document["headlines"]) {
    INFO(row);
    CHECK(row.contains("required") == row.contains("met"));
    if (row.contains("met"))
      CHECK(row["met"].get<bool>() ==
            (row["ratio"].get<double>() >= row["required"].get<double>()));
  }
}

TEST_CASE("the table of the committed comparison shows every row, or the reason it is missing",
          "[unit]") {
  const auto run = python("scripts/peers.py --table results/peers.json");
  INFO(run.output);
  REQUIRE(run.status == 0);
  const Json document = results_file("peers.json");
  REQUIRE(document["rows"].size() > 10);
  for (const Json& row : document["rows"]) {
    INFO(row["name"]);
    CHECK(run.output.find(row["name"].get<std::string>()) != std::string::npos);
    CHECK(row["reason"].get<std::string>().empty() == (row["status"] == "ok"));
    CHECK(run.output.find(row["reason"].get<std::string>()) != std::string::npos);
  }
}

TEST_CASE("a row that there is not is refused with those that there are", "[unit]") {
  const auto run = python("scripts/peers.py --only no-such-row");
  INFO(run.output);
  CHECK(run.status == 2);
  CHECK(run.output.find("--only no-such-row") != std::string::npos);
  CHECK(run.output.find("mkl-sobol-fp32") != std::string::npos);
}
