// koksma quality: its JSON is valid and holds what the stage measures, its picture is a picture,
// its errors say what is wrong.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "quality/picture.hpp"
#include "quality/star.hpp"
#include "tests/quality_support.hpp"

using namespace koksma;
using Catch::Contains;
using test::CommandResult;
using test::run_command;

namespace {

Json quality_of(const std::string& arguments) {
  const CommandResult result = run_command("quality " + arguments + " --json");
  INFO(result.output);
  REQUIRE(result.status == 0);
  Json json = parse_json(result.output, "quality");
  CHECK_NOTHROW(check_schema(json, "results/quality.schema.json", "quality"));
  return json;
}

// Every number is there or has a reason, never both.
void check_reasons(const Json& entry, const std::string& value, const std::string& reason) {
  CHECK(entry[value].is_null() == entry[reason].is_string());
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t result = 0;
  for (std::size_t i = 0; i < 4; ++i)
    result = result << 8 | static_cast<unsigned char>(bytes[at + i]);
  return result;
}

// Width and height after the PNG specification: signature, then IHDR.
std::pair<std::uint32_t, std::uint32_t> png_size(const std::string& bytes) {
  REQUIRE(bytes.size() > 57);
  CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(bytes.substr(12, 4) == "IHDR");
  CHECK(bytes.substr(bytes.size() - 8, 4) == "IEND");
  return {big_endian(bytes, 16), big_endian(bytes, 20)};
}

void check_refused(const std::string& arguments, const std::vector<std::string>& parts) {
  const CommandResult result = run_command("quality " + arguments);
  INFO("koksma quality " << arguments << "\n" << result.output);
  CHECK(result.status == 2);
  CHECK_THAT(result.output, Catch::StartsWith("koksma: "));
  for (const std::string& part : parts) CHECK_THAT(result.output, Contains(part));
}

}  // namespace

TEST_CASE("the JSON is valid, says how each number is known, and why one is missing", "[device]") {
  for (const char* points :
       {"--sampler sobol --dim 2 --n 256", "--sampler sobol-owen --dim 5 --n 100",
        "--sampler random --dim 1 --n 1", "--sampler lattice --dim 3 --n 2^8"}) {
    const Json json = quality_of(points);
    INFO(points);
    for (const auto& [name, measure] : json["measures"].items()) {
      INFO(name);
      check_reasons(measure, "value", "reason");
    }
    check_reasons(json["averages"]["pair_correlation"], "value", "reason");
    check_reasons(json["averages"]["power_spectrum"], "value", "reason");
    CHECK(json["measures"]["cd2"]["squared"] == true);
    CHECK(json["measures"]["l2star"]["squared"] == false);
    CHECK(json["measures"]["star"]["squared"].is_null());
    const Json& m = json["measures"];
    if (m["star_upper"]["value"].is_number() && m["star_lower"]["value"].is_number())
      CHECK(m["star_lower"]["value"].get<double>() <= m["star_upper"]["value"].get<double>());
  }
}

TEST_CASE("the numbers are those of the points that `points` writes", "[device]") {
  const Json json = quality_of("--sampler sobol-owen --dim 2 --n 200 --seed 5 --replicates 3");
  const PointSet p{2, test::points({.sampler = "sobol-owen", .dim = 2, .count = 200, .seed = 5})};
  CHECK(json["measures"]["star"]["value"] == star_exact(test::quality_kernels(), p));
  CHECK(json["averages"]["sets"] == 3);
  CHECK(json["context"]["seed"] == 5);
  CHECK(json["context"]["request"]["n"] == 200);
  CHECK_THAT(json["context"]["command"].get<std::string>(), Contains("--replicates 3"));
  CHECK(json["points"]["precision"] == "fp64");
}

TEST_CASE("deterministic points are one set, randomized planar ones 16", "[device]") {
  CHECK(quality_of("--sampler sobol --dim 2 --n 64")["averages"]["sets"] == 1);
  CHECK(quality_of("--sampler sobol-shift --dim 2 --n 64")["averages"]["sets"] == 16);
  CHECK(quality_of("--sampler sobol-shift --dim 3 --n 64")["averages"]["sets"] == 1);
}

TEST_CASE("replicates that are shifts of one set are not said to be averaged", "[device]") {
  const std::string lattice = "--sampler lattice-shift --dim 2 --n 64 --replicates 4";
  CHECK(quality_of(lattice)["averages"]["power_spectrum"]["value"]["distinct_sets"] == 1);
  CHECK_THAT(run_command("quality " + lattice).output,
             Contains("power spectrum: 1 distinct, the other sets are shifts of these"));
}

TEST_CASE("a scene gets variation times star discrepancy, above its error", "[device]") {
  const Json json = quality_of(
      "--sampler sobol-owen --dim 2 --n 128 --scene genz-gaussian:d=2 --scene "
      "genz-oscillatory:d=2");
  REQUIRE(json["koksma_hlawka"].size() == 2);
  const Json& known = json["koksma_hlawka"][0];
  CHECK(known["scene"] == "genz-gaussian:d=2");
  CHECK(known["anchor"] == 1);
  CHECK(known["bound"].get<double>() ==
        Approx(known["variation"].get<double>() * json["measures"]["star"]["value"].get<double>()));
  CHECK(known["error"].get<double>() > 0);
  CHECK(known["error"].get<double>() <= known["bound"].get<double>());
  const Json& unknown = json["koksma_hlawka"][1];
  CHECK(unknown["bound"].is_null());
  CHECK_THAT(unknown["bound_reason"].get<std::string>(), Contains("variation is unknown"));
  CHECK(unknown["error"].is_number());
}

TEST_CASE("the table and the file hold what the JSON holds", "[device]") {
  const test::TemporaryFolder folder;
  const CommandResult table =
      run_command("quality --sampler sobol --dim 2 --n 64 --out " + folder.path("q.json"));
  CHECK(table.status == 0);
  const Json json = parse_json(read_text_file(folder.path("q.json")), "q.json");
  for (const auto& [name, measure] : json["measures"].items())
    CHECK_THAT(table.output, Contains(measure["title"].get<std::string>()));
  CHECK_THAT(table.output, Contains("over 1 set\n"));
}

TEST_CASE("the picture is a PNG of the stated size and not blank", "[device]") {
  const test::TemporaryFolder folder;
  const auto size = [&](const std::string& points) {
    const CommandResult result =
        run_command("quality " + points + " --picture " + folder.path("q.png"));
    INFO(result.output);
    REQUIRE(result.status == 0);
    return png_size(read_text_file(folder.path("q.png")));
  };
  CHECK(size("--sampler sobol --dim 1 --n 16") == std::pair{612U, 640U});
  CHECK(size("--sampler sobol --dim 2 --n 16") == std::pair{1764U, 640U});
  const auto blank = read_text_file(folder.path("q.png")).size();
  CHECK(size("--sampler sobol-owen --dim 2 --n 1000") == std::pair{1764U, 640U});
  CHECK(read_text_file(folder.path("q.png")).size() > blank + 1000);
  CHECK(size("--sampler sobol --dim 9 --n 16") == std::pair{1488U, 940U});
}

TEST_CASE("a canvas blends coverage: a dot has the area of its disk, a fill its fractions",
          "[unit]") {
  // White is 1 in every channel, so the ink is what is missing from it.
  const Canvas blank(16, 16);
  Canvas dotted(16, 16);
  dotted.dot(8.2, 7.9, 3, {0, 0, 0});
  CHECK(dotted.ink() - blank.ink() == Approx(9 * 3.14159).epsilon(0.03));
  Canvas small(16, 16);
  small.dot(8.5, 8.5, 0.25, {0, 0, 0});
  CHECK(small.ink() == Approx(0.25).epsilon(0.1));
  Canvas filled(16, 16);
  filled.fill(1.25, 2.5, 3.75, 4, {0, 0, 0});
  CHECK(filled.ink() == Approx(2.5 * 1.5));
  filled.fill(-5, -5, 0.5, 0.5, {0, 0, 0});  // what lies outside is cut
  CHECK(filled.ink() == Approx(2.5 * 1.5 + 0.25));
  // Whatever the scale, an image keeps its mean, and no background comes through.
  for (const std::size_t columns : {1U, 3U, 10U, 37U}) {
    Canvas canvas(10, 10);
    std::vector<Colour> colours(columns * columns, Colour{0, 0, 0});
    canvas.image(0, 0, 10, columns, colours);
    CHECK(canvas.ink() == Approx(100));
  }
}

TEST_CASE("what is asked for wrongly is refused with what is allowed", "[unit]") {
  check_refused("--sampler sobl --dim 2 --n 16", {"--sampler: unknown sampler 'sobl'", "'sobol'?"});
  check_refused("--sampler sobol --dim 0 --n 16", {"--dim: 0", "1 to 3667"});
  check_refused("--sampler sobol --dim 4000 --n 16", {"--dim: 4000", "1 to 3667"});
  check_refused("--sampler sobol --dim 2 --n 2^4..2^6", {"--n", "one number of points"});
  check_refused("--sampler lattice --dim 2 --n 1000", {"--n: N = 1000", "512 and 1024"});
  check_refused("--sampler lattice --dim 2 --n 2^21", {"--n: ", "2^20 points"});
  check_refused("--sampler sobol --dim 2 --n 2^40", {"--n, --dim", "coordinates"});
  check_refused("--sampler sobol --dim 2 --n 16 --replicates 2",
                {"--replicates: 2", "not randomized: only 1"});
  check_refused("--sampler sobol --dim 2 --n 16 --replicates 0", {"--replicates"});
  check_refused("--sampler sobol --dim 2 --n 16 --scene ishigami",
                {"--scene: 'ishigami:d=3' has d = 3", "write d=2"});
  check_refused("--sampler sobol --dim 2 --n 16 --picture q.jpg", {"--picture: 'q.jpg'", ".png"});
  check_refused("--sampler sobol --dim 2 --n 16 --picture /none/q.png",
                {"/none/q.png", "cannot write: No such file or directory"});
  check_refused("--sampler sobol --dim 2 --n 16 --out /none/q.json", {"cannot write"});
  check_refused("--sampler sobol --dim 2", {"--n", "required"});
  check_refused("--sampler sobol --dim 2 --n 16 --pictrue q.png", {"did you mean '--picture'?"});
  CHECK(run_command("quality --help").status == 0);
}

TEST_CASE("quality refuses averages outside the plane and more coordinates than it can hold",
          "[device]") {
  const auto replicates = run_command("quality --sampler sobol-owen --dim 3 --n 64 --replicates 4");
  CHECK(replicates.status == 2);
  CHECK_THAT(replicates.output, Contains("--replicates: 4; d = 3: only in the plane"));
  const auto size = run_command("quality --sampler random --dim 2 --n 2^26");
  CHECK(size.status == 2);
  CHECK_THAT(size.output, Contains("16 sets; at most 268435456 coordinates in all"));
}
