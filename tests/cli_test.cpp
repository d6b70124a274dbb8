// What list, points and explain print is what the catalog and the kernels hold.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <sstream>

#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;
using koksma::test::CommandResult;
using koksma::test::run_command;

namespace {

// Reads what `points` wrote, by the definition of NumPy's format 1.0.
struct Npy {
  std::string header;
  std::vector<double> values;
};
Npy read_npy(const std::string& path) {
  const std::string bytes = read_text_file(path);
  REQUIRE(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length =
      static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  CHECK((10 + length) % 64 == 0);
  Npy npy{bytes.substr(10, length), {}};
  const bool wide = npy.header.find("<f8") != std::string::npos;
  for (std::size_t at = 10 + length; at < bytes.size(); at += wide ? 8 : 4) {
    double value = 0;
    float single = 0;
    std::memcpy(wide ? static_cast<void*>(&value) : &single, bytes.data() + at, wide ? 8 : 4);
    npy.values.push_back(wide ? value : static_cast<double>(single));
  }
  return npy;
}

}  // namespace

TEST_CASE("list prints every entry of the catalog, as text and as JSON", "[unit]") {
  const auto check_kind = [](const std::string& kind, const auto& entries) {
    const CommandResult text = run_command("list " + kind),
                        json = run_command("list " + kind + " --json");
    CHECK(text.status == 0);
    CHECK(json.status == 0);
    const Json list = Json::parse(json.output);
    REQUIRE(list.size() == entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      CHECK(list[i]["name"] == entries[i].name);
      CHECK(list[i]["title"] == entries[i].title);
      CHECK_THAT(text.output, Contains(entries[i].name) && Contains(entries[i].title));
    }
    CHECK(std::count(text.output.begin(), text.output.end(), '\n') ==
          static_cast<std::ptrdiff_t>(entries.size()));
  };
  check_kind("integrands", test::catalog().integrands);
  check_kind("samplers", test::catalog().samplers);
  check_kind("estimators", test::catalog().estimators);
  check_kind("sums", test::catalog().sums);
  const Json scenes = Json::parse(run_command("list scenes --json").output);
  CHECK(scenes.size() == test::catalog().integrands.size());
  for (const Json& s : scenes)
    CHECK(parse_scene(test::catalog(), s["name"].get<std::string>(), "list").text == s["name"]);
}

TEST_CASE("list devices tells what can be chosen", "[device]") {
  const Json devices = Json::parse(run_command("list devices --json").output);
  REQUIRE_FALSE(devices.empty());
  for (const Json& device : devices) {
    CHECK(device["fp64"].is_boolean());
    CHECK_THAT(run_command("list devices").output, Contains(device["title"].get<std::string>()));
  }
}

TEST_CASE(
    "points as .npy hold the points of the kernels in NumPy's format, at any start, replicate and "
    "precision",
    "[device]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path("p.npy");
  for (const bool wide : {true, false}) {
    const CommandResult result = run_command(
        "points --sampler sobol-owen --dim 3 --n 40 --start 1000 --seed 9 --replicate 2 "
        "--precision " +
        std::string(wide ? "fp64" : "fp32") + " --out " + out);
    INFO(result.output);
    REQUIRE(result.status == 0);
    const Npy npy = read_npy(out);
    CHECK_THAT(npy.header, Catch::StartsWith(std::string("{'descr': '") + (wide ? "<f8" : "<f4") +
                                             "', 'fortran_order': False, 'shape': (40, 3), }") &&
                               Catch::EndsWith("\n"));
    CHECK(npy.values == test::points({.sampler = "sobol-owen",
                                      .dim = 3,
                                      .precision = wide ? Precision::fp64 : Precision::fp32,
                                      .start = 1000,
                                      .count = 40,
                                      .replicate = 2,
                                      .seed = 9}));
  }
}

TEST_CASE("points as .csv have 17 digits, so that reading them gives the same bits", "[device]") {
  const test::TemporaryFolder folder;
  for (const Sampler& s : test::catalog().samplers) {
    if (!test::complete(s)) continue;
    const std::uint64_t n =
        s.extensible ? 32 : test::admitted_size(s, 2, 39);  // with --start 7: 32 points in both
    const CommandResult result = run_command(fmt::format(
        "points --sampler {} --dim 2 --n {} --start 7 --out {}", s.name, n, folder.path("p.csv")));
    INFO(s.name << " " << result.output);
    REQUIRE(result.status == 0);
    std::istringstream text(read_text_file(folder.path("p.csv")));
    std::vector<double> values;
    std::string line;
    while (std::getline(text, line)) {
      REQUIRE(std::count(line.begin(), line.end(), ',') == 1);
      values.push_back(std::stod(line));
      values.push_back(std::stod(line.substr(line.find(',') + 1)));
    }
    CHECK(
        values ==
        test::points(
            {.sampler = s.name, .dim = 2, .start = 7, .count = s.extensible ? n : n - 7, .n = n}));
  }
}

TEST_CASE("points written in several pieces join without a seam", "[device]") {
  const test::TemporaryFolder folder;
  // 4000 dimensions: a piece holds few points, so that there are several.
  const std::string base = "points --sampler random --dim 4000 --precision fp32 ";
  REQUIRE(run_command(base + "--n 600 --out " + folder.path("all.npy")).status == 0);
  REQUIRE(run_command(base + "--start 250 --n 40 --out " + folder.path("part.npy")).status == 0);
  const auto all = read_npy(folder.path("all.npy")).values,
             part = read_npy(folder.path("part.npy")).values;
  REQUIRE(all.size() == 2400000);
  CHECK(std::equal(part.begin(), part.end(), all.begin() + 250L * 4000));
}

TEST_CASE("explain prints the kernel that runs and what was left out and why", "[device]") {
  const CommandResult result =
      run_command("explain --scene linear-prod:d=8 --sampler sobol-owen --n 2^12 --precision fp32");
  INFO(result.output);
  CHECK(result.status == 0);
  Cell cell = test::cell("linear-prod:d=8", "sobol-owen", 4096, 32);
  cell.precision = Precision::fp32;
  const Plan plan = make_plan(test::catalog(), cell, test::device().facts());
  CHECK_THAT(result.output, Catch::EndsWith("kernel source\n" + plan.program.text));
  for (const LeftOut& item : plan.left_out)
    CHECK_THAT(result.output, Contains("\n  " + item.what + ": " + item.why + "\n"));
  CHECK(plan.left_out.size() >= 3);
  CHECK_THAT(result.output, Contains("#line 1 \"" + plan.integrand->code.path + "\"") &&
                                Contains("#define KOKSMA_DIM 8\n") && Contains("\npoint table "));
  // One sampler's code and one integrand's, no other.
  for (const Family& family : test::catalog().families)
    CHECK((result.output.find("#line 1 \"" + family.code.path + "\"") != std::string::npos) ==
          (family.name == plan.sampler->family));
  for (const Integrand& f : test::catalog().integrands)
    CHECK((result.output.find("#line 1 \"" + f.code.path + "\"") != std::string::npos) ==
          (f.name == "linear-prod"));
}

TEST_CASE("explain counts the randomizations of a median, all of which have a table", "[device]") {
  const CommandResult result = run_command(
      "explain --scene linear-prod:d=2 --sampler sobol-lms-shift --estimator median --n 2^8 "
      "--replicates 4");
  INFO(result.output);
  CHECK_THAT(result.output,
             Contains("median, 4 replicates: medians of 15 randomizations, 60 in all\n"));
  const std::size_t at = result.output.find("point table ");
  REQUIRE(at != std::string::npos);
  std::istringstream line(result.output.substr(at));
  std::string word, bytes_word;
  double bytes = 0, each = 0;
  line >> word >> word >> bytes >> bytes_word >> each;
  CHECK(each == Approx(bytes / 2 / 60).margin(0.051));
  CHECK_THAT(result.output, Contains(" per dimension and randomization\n"));
}

TEST_CASE("a deterministic net is refused where fp32 cannot tell its points apart", "[device]") {
  const koksma::test::TemporaryFolder folder;
  const CommandResult points =
      run_command("points --sampler sobol --dim 2 --n 16 --start 8388608 --precision fp32 --out " +
                  folder.path("x.csv"));
  CHECK(points.status == 2);
  CHECK_THAT(points.output, Contains("exact to 23 bits in fp32"));
  const CommandResult run = run_command(
      "run --scene linear-prod:d=1 --sampler sobol --sampler sobol-shift --precision fp32 "
      "--n 2^24 --replicates 2 --quiet --out " +
      folder.path("r.json"));
  CHECK(run.status == 0);
  const Json cells = Json::parse(read_text_file(folder.path("r.json")))["cells"];
  CHECK(cells[0]["status"] == "unsupported");
  CHECK_THAT(cells[0]["reason"].get<std::string>(), Contains("would repeat points"));
  CHECK(cells[1]["status"] == "ok");
  CHECK(cells[1]["rows"][0]["grid_limited"] == true);
}
