// What is wrong with a user's pair of files is told once, by file and place, with status 2, before
// anything is measured.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;
using test::CommandResult;

namespace {

// The sum of the coordinates, `kernel` its body's last word; the entry's `exact` and `checks`.
struct OwnFiles {
  test::TemporaryFolder folder;
  std::string exact_code =
      "static double exact_mean(params q, uint d) { return d / 2.0; }\n"
      "static double exact_variance(params q, uint d) { return d / 12.0; }\n";
  std::string draws = "KOKSMA_DIM", result = "s";
  std::string parameters = "[]";
  std::string exact = R"({"mean": {"from": "formula"}, "variance": {"from": "formula"}})";
  std::string checks = "[]";

  CommandResult run(const std::string& samplers = "--sampler sobol-owen") const {
    folder.write("mine.json", fmt::format(R"({{
      "name": "mine", "title": "t", "citation": "c", "reference": [], "class": "smooth",
      "periodic": false, "parameters": {}, "dimensions": {{"min": 1, "max": 9, "default": 2}},
      "draws": "d", "coefficients": [], "transforms": [], "exact_operations": true,
      "nonnegative": true, "exact": {}, "checks": {}}})",
                                          parameters, exact, checks));
    folder.write("mine.cl", fmt::format(R"(#ifdef KOKSMA_EXACT
{}#else
static inline real integrand(points *p, params q, coefficients c) {{
  real s = R(0.0);
  for (uint j = 0; j < {}; ++j) s += points_next(p);
  return {};
}}
#endif
)",
                                        exact_code, draws, result));
    return test::run_command("run --integrand " + folder.path("mine.json") +
                             " --scene mine:d=2 --scene linear-prod:d=2 " + samplers +
                             " --n 2^8 --out " + folder.path("r.json"));
  }

  void set_check(const std::string& mean, const std::string& variance) {
    checks = fmt::format(
        R"([{{"d": 2, "parameters": {{}}, "mean": "{}", "variance": {}, "verified": "by hand"}}])",
        mean, variance);
  }

  // Status 2, these texts, and nothing measured.
  void check_refused(const std::vector<std::string>& parts,
                     const std::string& samplers = "--sampler sobol-owen") const {
    const CommandResult command = run(samplers);
    INFO(command.output);
    CHECK(command.status == 2);
    for (const std::string& part : parts) CHECK_THAT(command.output, Contains(part));
    CHECK_FALSE(std::filesystem::exists(folder.path("r.json")));
    CHECK_THAT(command.output, !Contains("RMSE"));
  }
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

}  // namespace

TEST_CASE("a good pair runs; of what is exact only the mean must be said", "[device]") {
  OwnFiles own;
  own.set_check("1", "\"0.16666666666666666666\"");
  const auto full = own.run();
  INFO(full.output);
  CHECK(full.status == 0);
  own.exact = R"({"mean": {"from": "none"}})";
  const auto unknown = own.run();
  INFO(unknown.output);
  CHECK(unknown.status == 0);
  CHECK_THAT(unknown.output, Contains("own-estimate"));
}

TEST_CASE("a kernel that draws another number of coordinates than the scene has is refused",
          "[device]") {
  OwnFiles own;
  own.draws = "KOKSMA_DIM + 3";
  own.check_refused({"mine.cl", "draws 5 coordinates", "d = 2"});
}

TEST_CASE("a kernel that leaves out coordinates of some samples is refused", "[device]") {
  OwnFiles own;
  own.draws = "KOKSMA_DIM - (uint)(j == 1 && !any_lane(s > R(0.9375)))";
  own.check_refused({"mine.cl", "draws 1 to 2 coordinates", "all d = 2"});
}

TEST_CASE("a mistake that the compiler finds is told once, by file and line", "[device]") {
  const auto [exact, line] = GENERATE(table<bool, int>({{true, 2}, {false, 8}}));
  OwnFiles own;
  // A Latin-1 byte beside the mistake: what compilers quote need not be UTF-8.
  if (exact)
    own.exact_code.replace(own.exact_code.find("d / 2.0"), 7, "two / 2.0 /* \xE9 */");
  else
    own.result = "two /* \xE9 */";
  const std::string code = own.folder.path("mine.cl");
  const auto place = fmt::format("{}:{}:", code, line);
  const std::string samplers = "--sampler sobol --sampler random";
  own.check_refused({code + ": does not compile:\n", place, "two"}, samplers);
  CHECK(count(own.run(samplers).output, place) == 1);
}

TEST_CASE("a function that the entry promises and the code lacks is told by both files", "[unit]") {
  OwnFiles own;
  own.exact_code = "static double exact_variance(params q, uint d) { return d / 12.0; }\n";
  const std::string code = own.folder.path("mine.cl"), json = own.folder.path("mine.json");
  own.check_refused(
      {code + ": exact_mean is missing; " + json + ", at '/exact/mean' says formula"});
  own.exact_code += "static double exact_mean_abs(params q, uint d) { return d / 2.0; }\n";
  own.check_refused({"exact_mean is missing"});
  own.exact_code += "static double exact_mean (params q, uint d) { return d / 2.0; }\n";
  own.exact = R"({"mean": {"from": "formula"}, "variation": {"from": "formula"}})";
  own.check_refused({"exact_variation is missing", "at '/exact/variation' says formula"});
}

TEST_CASE("a formula that gives no number is an error, not an unknown integral", "[device]") {
  OwnFiles own;
  const std::string number = GENERATE("NAN", "INFINITY", "-INFINITY");
  // At d = 2 only, which is the scene's.
  own.exact_code =
      "static double exact_mean(params q, uint d) { return d == 2 ? " + number + " : d / 2.0; }\n";
  own.exact = R"({"mean": {"from": "formula"}})";
  own.check_refused(
      {own.folder.path("mine.json") + ", at '/exact/mean'", "no finite number", "mine:d=2"});
  // At d = 3 only, which a check has.
  own.exact_code.replace(own.exact_code.find("d == 2"), 6, "d == 3");
  own.set_check("1.5", "null");
  own.checks.replace(own.checks.find("\"d\": 2"), 6, "\"d\": 3");
  own.check_refused({"mine.cl: exact_mean gives no finite number at d = 3", "1.5"});
}

TEST_CASE("the mean and the variance must agree with the entry's own checks, relative to them",
          "[device]") {
  OwnFiles own;
  own.set_check("0.75", "null");
  own.check_refused({"mine.cl: exact_mean gives 1 at d = 2", "0.75"});
  own.set_check("1", "\"0.17\"");
  own.check_refused({"mine.cl: exact_variance gives 0.1666", "0.17"});
  own.exact = R"({"mean": {"from": "constant", "value": "1.1"}})";
  own.check_refused({"mine.json, at '/exact/mean': the constant gives 1.1", "says 1"});
  // Wrong by 1e-7 of a small mean; the entry's tolerance may allow it.
  own.exact_code = "static double exact_mean(params q, uint d) { return 1.0000001e-6; }\n";
  own.exact = R"({"mean": {"from": "formula"}})";
  own.set_check("1e-6", "null");
  own.check_refused({"exact_mean gives 1.0000001e-06"});
  own.exact = R"({"mean": {"from": "formula", "tolerance": 1e-6}})";
  CHECK(own.run().status == 0);
  // Absolute where the value is 0.
  own.exact_code = "static double exact_mean(params q, uint d) { return 1e-10; }\n";
  own.exact = R"({"mean": {"from": "formula"}})";
  own.set_check("0", "null");
  CHECK(own.run().status == 0);
}
