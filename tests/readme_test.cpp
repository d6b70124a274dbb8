// README is true: its example integrand runs as printed, its study is valid, its table of samplers
// is the catalog's.
#include <catch2/catch.hpp>
#include <string>

#include "tests/support.hpp"

using namespace koksma;

namespace {

// The first fenced block of `language` that contains `word`.
std::string code_block(const std::string& text, const std::string& language,
                       const std::string& word) {
  const std::string fence = "```" + language + "\n";
  for (std::size_t at = text.find(fence); at != std::string::npos; at = text.find(fence, at + 1)) {
    const std::size_t begin = at + fence.size();
    std::string block = text.substr(begin, text.find("```", begin) - begin);
    if (block.find(word) != std::string::npos) return block;
  }
  FAIL("README has no " << language << " block with " << word);
  return "";
}

}  // namespace

TEST_CASE("README's example of an integrand of one's own runs as printed", "[device]") {
  const std::string readme = test::repository_file("README.md");
  const test::TemporaryFolder folder;
  folder.write("bump.cl", code_block(readme, "c", "integrand("));
  folder.write("bump.json", code_block(readme, "json", "\"bump\""));
  const auto run = test::run_command(
      "run --integrand " + folder.path("bump.json") +
      " --scene bump:d=4 --sampler sobol-owen --sampler random --n 2^8..2^13 --out " +
      folder.path("out.json"));
  INFO(run.output);
  REQUIRE(run.status == 0);
  const Json results = parse_json(read_text_file(folder.path("out.json")), "out.json");
  REQUIRE(results["cells"].size() == 2);
  CHECK(results["cells"][0]["scene"]["exact"]["mean"]["value"].get<double>() ==
        Approx(16.0 / 81).epsilon(1e-14));
  CHECK(results["cells"][0]["rows"].back()["rmse"].get<double>() < 1e-4);
  CHECK(results["cells"][0]["convergence"]["rate"].get<double>() < -1);
}

TEST_CASE("README's study is valid", "[unit]") {
  const Json study =
      parse_json(code_block(test::repository_file("README.md"), "json", "\"cells\""), "README.md");
  CHECK_NOTHROW(check_schema(study, "harness/study/study.schema.json", "README.md"));
}

TEST_CASE("README names every sampler, integrand and estimator", "[unit]") {
  const std::string readme = test::repository_file("README.md");
  const auto names = [&](const auto& entries) {
    for (const auto& entry : entries) {
      INFO(entry.name);
      CHECK(readme.find("`" + entry.name + "`") != std::string::npos);
    }
  };
  names(test::catalog().integrands);
  names(test::catalog().estimators);
  for (const Sampler& s : test::catalog().samplers) {
    INFO(s.name);
    CHECK(readme.find("`" + s.name + "`") != std::string::npos);
  }
}
