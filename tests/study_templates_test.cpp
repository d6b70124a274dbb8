// The ready studies of `koksma study`.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "study/templates.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::run_command;

TEST_CASE("every ready study is valid as it is written out, and has a title", "[unit]") {
  const test::TemporaryFolder folder;
  std::set<std::string> names;
  for (const StudyTemplate& each : study_templates()) {
    INFO(each.name);
    names.insert(each.name);
    CHECK_FALSE(each.title.empty());
    const std::string path =
        folder.write(each.name + ".json", ready_study(test::catalog(), each.name).dump(2));
    StudyFlags flags;
    flags.own_directions = true;  // one study goes beyond the built-in dimensions
    CHECK_FALSE(read_study(test::catalog(), path, flags).cells.empty());
  }
  for (const char* name :
       {"smooth", "discontinuous", "high-dimensional", "periodic", "singular", "rates", "full"})
    CHECK(names.count(name) == 1);
}

TEST_CASE("the full study holds every integrand of the catalog", "[unit]") {
  const Json study = ready_study(test::catalog(), "full");
  std::set<std::string> integrands;
  for (const Json& block : study["cells"])
    for (const std::string scene : block["scenes"])
      integrands.insert(parse_scene(test::catalog(), scene, "test").integrand);
  for (const Integrand& f : test::catalog().integrands) CHECK(integrands.count(f.name) == 1);
}

TEST_CASE("the gated study has all that is gated: d <= 2, N = 2^8 to 2^16, 32 replicates, fp64",
          "[unit]") {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("rates.json", ready_study(test::catalog(), "rates").dump());
  std::set<std::string> samplers;
  for (const Cell& cell : read_study(test::catalog(), path, {}).cells) {
    CHECK(cell.scene.dim <= 2);
    CHECK(cell.n.front() == 1 << 8);
    CHECK(cell.n.back() == 1 << 16);
    CHECK(cell.replicates == 32);
    CHECK(cell.precision == Precision::fp64);
    samplers.insert(cell.sampler);
  }
  CHECK(samplers.size() >= 6);
}

TEST_CASE("koksma study writes a file that koksma run takes, and writes over none", "[device]") {
  const test::TemporaryFolder folder;
  const std::string file = folder.path("default.json");
  const auto written = run_command(fmt::format("study default --out {}", file));
  CHECK(written.status == 0);
  CHECK(written.output.find("koksma run " + file) != std::string::npos);
  const auto again = run_command(fmt::format("study default --out {}", file));
  CHECK(again.status == 2);
  CHECK(again.output.find("exists already") != std::string::npos);
  CHECK(run_command(fmt::format("study default --force --out {}", file)).status == 0);
  const auto run = run_command(fmt::format("run {} --quiet --n 2^8 --sampler random --out {}", file,
                                           folder.path("results.json")));
  INFO(run.output);
  CHECK(run.status == 0);
  CHECK(std::filesystem::exists(folder.path("results.json")));
}

TEST_CASE("koksma study without a name lists the studies, and knows the nearest name", "[unit]") {
  const auto list = run_command("study");
  CHECK(list.status == 0);
  for (const StudyTemplate& each : study_templates())
    CHECK(list.output.find(each.name + " ") != std::string::npos);
  const auto wrong = run_command("study smoth");
  CHECK(wrong.status == 2);
  CHECK(wrong.output.find("smooth") != std::string::npos);
}
