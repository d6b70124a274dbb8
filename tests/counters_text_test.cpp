// Counters are an option at build time: without them the kernel is the text it was without their
// code, and with them that text and the counting, nothing else.
#include <catch2/catch.hpp>
#include <regex>
#include <sstream>

#include "catalog/embedded.hpp"
#include "plan/compose.hpp"
#include "tests/support.hpp"

using namespace koksma;
using test::cell;

namespace {

Plan plan_counted(const std::string& sampler, const PlanOptions& options = {}) {
  return make_plan(test::catalog(), cell("linear-prod:d=3", sampler, 256), DeviceFacts{}, "",
                   options);
}

// Of all pieces as they are written: pruning takes out more of some than of others.
std::string program(const std::string& sampler, const PlanOptions& options = {}) {
  return compose_whole(test::catalog(), plan_counted(sampler, options), ProgramKind::integrate)
      .text;
}

PlanOptions counting() {
  PlanOptions options;
  options.counters = true;
  return options;
}

// Lines without comments; blank ones left out.
std::string code_of(const std::string& text) {
  std::istringstream lines(text);
  std::string line, code;
  while (std::getline(lines, line)) {
    line = std::regex_replace(line, std::regex(R"(\s*//.*|\s+$)"), "");
    if (!line.empty()) code += line + "\n";
  }
  return code;
}

// Without the sections #if KOKSMA_COUNTERS ... #endif, which have no #else.
std::string without_counters(const std::string& text) {
  std::istringstream lines(text);
  std::string line, kept;
  int depth = 0;  // of conditions since the section began
  while (std::getline(lines, line)) {
    if (depth > 0) {
      REQUIRE((depth > 1 || !line.starts_with("#el")));
      depth += line.starts_with("#if") ? 1 : line.starts_with("#endif") ? -1 : 0;
    } else if (line == "#if KOKSMA_COUNTERS") {
      depth = 1;
    } else {
      kept += line + "\n";
    }
  }
  REQUIRE(depth == 0);
  return kept;
}

// Of the composed text, what follows `#line 1 "<path>"`, up to the next piece.
std::string piece(const std::string& text, const std::string& path) {
  const std::string head = "#line 1 \"" + path + "\"\n";
  const std::size_t begin = text.find(head);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = text.find("\n#line 1 ", begin);
  return text.substr(begin + head.size(), end == std::string::npos ? end : end - begin);
}

std::string without(std::string text, const std::string& part) {
  const std::size_t at = text.find(part);
  REQUIRE(at != std::string::npos);
  return text.erase(at, part.size());
}

}  // namespace

TEST_CASE("without counters the integration kernel is the code it is without their sections",
          "[unit]") {
  const std::string expected = code_of(test::repository_file("tests/integrate_plain.cl"));
  REQUIRE(expected.size() > 2000);
  for (const char* sampler : {"sobol-owen", "random", "sobol:randomize=rotate"}) {
    const std::string text = program(sampler);
    INFO(sampler);
    CHECK(code_of(without_counters(piece(text, "kernels/integrate.cl"))) == expected);
    // Nothing else of them is there.
    CHECK(code_of(without_counters(text)).find("KOKSMA_COUNTERS") == std::string::npos);
    CHECK(text.find("kernels/counters.cl") == std::string::npos);
    CHECK(text.find("watched_") == std::string::npos);
    CHECK(text.find("#define KOKSMA_COUNTERS") == std::string::npos);
    CHECK(code_of(plan_counted(sampler).program.text).find("KOKSMA_COUNTERS") == std::string::npos);
  }
}

TEST_CASE("a plan with counters adds their defines and their piece to the text, and no more",
          "[unit]") {
  for (const char* sampler : {"sobol-owen", "random", "sobol:randomize=rotate"}) {
    std::string text = program(sampler, counting());
    text = without(text, "#define KOKSMA_COUNTERS 1\n");
    text = without(text, "#define KOKSMA_COUNTERS_FP64 1\n");
    const std::string path = "kernels/counters.cl";
    text = without(text,
                   "#line 1 \"" + path + "\"\n" + std::string(embedded_text(path.c_str())) + "\n");
    INFO(sampler);
    CHECK(text == program(sampler));
  }
  DeviceFacts fp32_only;
  fp32_only.fp64 = false;
  CHECK_THAT(
      make_plan(test::catalog(), cell("linear-prod:d=3", "random", 256), fp32_only, "", counting())
          .program.text,
      Catch::Contains("#define KOKSMA_COUNTERS_FP64 0\n"));
}

TEST_CASE("the program built after a fault is that of a plan with counters", "[unit]") {
  const Cell c = cell("linear-prod:d=3", "sobol-owen", 256);
  const Plan plan = make_plan(test::catalog(), c, DeviceFacts{});
  CHECK(counting_program(test::catalog(), plan).text ==
        plan_counted("sobol-owen", counting()).program.text);
  const auto notes = [](const Plan& p) {
    return std::count_if(p.left_out.begin(), p.left_out.end(), [](const LeftOut& item) {
      return item.what == "counters of exceptional samples";
    });
  };
  CHECK(notes(plan) == 1);
  CHECK(notes(make_plan(test::catalog(), c, DeviceFacts{}, "", counting())) == 0);
}
