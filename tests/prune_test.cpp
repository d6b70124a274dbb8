// The text of a plan: closed branches and unreached functions are not in it, and everything that it
// needs is.
#include "plan/prune.hpp"

#include <catch2/catch.hpp>
#include <map>
#include <regex>
#include <set>

#include "plan/compose.hpp"
#include "plan/conditionals.hpp"
#include "plan/tokens.hpp"
#include "tests/support.hpp"

using namespace koksma;
using Catch::Contains;

namespace {

std::string prune(const std::string& text) { return pruned("#line 1 \"piece.cl\"\n" + text).text; }

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The names that the code holds, without comments.
std::set<std::string> names_of(const std::string& text) {
  std::set<std::string> names;
  for (const Token& token : tokens_of(text))
    if (token.kind == Token::Kind::identifier) names.emplace(token.text);
  return names;
}

// Directives that leave a question to the compiler.
int open_questions(const std::string& text) {
  int count = 0;
  for (const SourceLine& line : source_lines(text)) {
    const std::string_view directive = directive_of(line.text);
    count += directive.starts_with("if") || directive.starts_with("el") || directive == "endif";
  }
  return count;
}

DeviceFacts some_device() {
  DeviceFacts facts;
  facts.max_allocation = std::uint64_t{1} << 30;
  return facts;
}

// Names of the functions that a program defines, and how often each is named.
std::map<std::string, int> functions_of(const std::string& text) {
  std::map<std::string, int> functions;
  static const std::regex kDefinition(R"(static[^;{()=]*?\b(\w+)\s*\()");
  for (auto it = std::sregex_iterator(text.begin(), text.end(), kDefinition);
       it != std::sregex_iterator(); ++it)
    functions.emplace((*it)[1], 0);
  for (const Token& token : tokens_of(text)) {
    const auto found = functions.find(std::string(token.text));
    if (found != functions.end()) ++found->second;
  }
  return functions;
}

Plan plan_to_prune(const Sampler& sampler, Precision precision) {
  Cell cell = test::cell("linear-prod:d=" + std::to_string(test::usual_dim(sampler)), sampler.name,
                         test::admitted_size(sampler, test::usual_dim(sampler), 256));
  cell.precision = precision;
  return make_plan(test::catalog(), cell, some_device());
}

}  // namespace

TEST_CASE("conditions are decided where integers and KOKSMA_ names decide them", "[unit]") {
  const Macros macros = {{"KOKSMA_A", " 2"},   {"KOKSMA_B", " (KOKSMA_A * 3)"},
                         {"OTHER", " 1"},      {"KOKSMA_LOOP", " KOKSMA_LOOP"},
                         {"KOKSMA_CALL", "("}, {"KOKSMA_MAYBE", std::nullopt}};
  const auto value = [&](const char* text) { return condition_value(text, macros); };
  CHECK(value("KOKSMA_A") == 2);
  CHECK(value("KOKSMA_B % 4 == 2") == 1);
  CHECK(value("1 + 2 * 3 - -1") == 8);
  CHECK(value("!KOKSMA_NONE && (KOKSMA_A > 1 || KOKSMA_A < 0)") == 1);
  CHECK(value("defined(KOKSMA_A) && !defined KOKSMA_NONE") == 1);
  CHECK(value("defined(KOKSMA_CALL)") == 1);
  for (const char* unknown : {"__OPENCL_VERSION__ >= 120", "KOKSMA_A && SOMETHING", "KOKSMA_MAYBE",
                              "defined(KOKSMA_MAYBE)", "defined(cl_khr_fp64)", "KOKSMA_LOOP",
                              "1 / 0", "KOKSMA_CALL", "KOKSMA_A +", "", "1.5"}) {
    INFO(unknown);
    CHECK_FALSE(value(unknown).has_value());
  }
}

TEST_CASE("closed branches go, the compiler's own stay, and lines keep their numbers", "[unit]") {
  const std::string text = prune(
      "#define KOKSMA_A 1\n#if KOKSMA_A == 2\nint two;\n#elif KOKSMA_A\nint one;\n#else\nint "
      "none;\n#endif\n#ifdef cl_khr_fp64\ndouble wide;\n#else\nfloat wide;\n#endif\n#undef "
      "KOKSMA_A\n#ifndef KOKSMA_A\nint gone;\n#endif\n");
  CHECK_FALSE(has(text, "int two"));
  CHECK(has(text, "#line 5 \"piece.cl\"\nint one;"));
  CHECK_FALSE(has(text, "int none"));
  CHECK(has(text, "#ifdef cl_khr_fp64\ndouble wide;\n#else\nfloat wide;\n#endif\n"));
  CHECK(has(text, "#line 16\nint gone;"));
}

TEST_CASE("a directive of several lines is one, and what open questions name stays", "[unit]") {
  const std::string text = prune(
      "#define KOKSMA_A \\\n  (KOKSMA_B && \\\n   !KOKSMA_C)\n#define KOKSMA_B 1\n#if "
      "KOKSMA_A\nint "
      "yes;\n#else\nint no;\n#endif\n#define ASKED 1\n#define UNASKED 1\n#if __OPENCL_VERSION__ "
      "> 100 && \\\n  ASKED\nint new_one;\n#endif\n");
  CHECK(has(text, "#line 6 \"piece.cl\"\nint yes;"));
  CHECK_FALSE(has(text, "int no;"));
  CHECK(has(text, "#define ASKED 1\n"));
  CHECK_FALSE(has(text, "UNASKED"));
  CHECK(has(text, "> 100 && \\\n  ASKED\nint new_one;\n#endif\n"));
  CHECK_FALSE(has(text, "KOKSMA_A"));
}

TEST_CASE("functions and macros stay where the kernel reaches them, by whatever name", "[unit]") {
  const std::string text = prune(
      "// Says what used is.\nstatic inline int used(int x) { return x; }\n"
      "// Says what unused is.\nstatic inline int unused(int x) {\n  return used(x);\n}\n"
      "#define other_name renamed\n"
      "static int other_name(int x) { return x; }\n"
      "#define KOKSMA_TWICE(x) macro_calls(x) + (x)\n"
      "static int macro_calls(int x) { return x; }\n"
      "#define KOKSMA_NOBODY unused(1)\n"
      "static int made_float(int x) { return x; }\n"
      "#define join(x) made_##x\n"
      "__kernel void k(__global int *out) { *out = used(1) + renamed(2) + KOKSMA_TWICE(3) + "
      "join(float)(1); }\n");
  for (const char* kept : {"Says what used", "int used(", "int other_name(", "int macro_calls(",
                           "define KOKSMA_TWICE", "int made_float("}) {
    INFO(kept);
    CHECK(has(text, kept));
  }
  for (const char* dropped : {"unused", "NOBODY"}) {
    INFO(dropped);
    CHECK_FALSE(has(text, dropped));
  }
  CHECK(pruned("#define KOKSMA_DIM 3\n#line 1 \"a.cl\"\n// nothing\nstatic int f(void) { return 1; "
               "}\n#line 1 \"b.cl\"\n__kernel void k(void) {}\n")
            .text == "#define KOKSMA_DIM 3\n#line 1 \"b.cl\"\n__kernel void k(void) {}\n");
}

TEST_CASE("integrands are part of the kernel's body where its loops are unrolled", "[unit]") {
  const auto inlined = [](const char* scene) {
    const Cell cell = test::cell(scene, "random", 256);
    const std::string text = make_plan(test::catalog(), cell, some_device()).program.text;
    const auto asked = text.find("real integrand(points *p, params q, coefficients c) __attr");
    const auto defined = text.find("real integrand(points *p, params q, coefficients c) {");
    REQUIRE(defined != std::string::npos);
    return asked < defined;
  };
  CHECK(inlined("linear-prod:d=8"));
  CHECK_FALSE(inlined("linear-prod:d=1000"));
  CHECK_FALSE(inlined("asian-geometric-call-pca:d=16"));
}

TEST_CASE("the program of every sampler holds no function that nothing calls, and no open question",
          "[unit]") {
  std::size_t programs = 0, smaller = 0;
  for (const Sampler& sampler : test::samplers_by_kernel())
    for (const Precision precision : test::precisions(sampler)) {
      const Plan plan = plan_to_prune(sampler, precision);
      const std::string whole = compose_whole(test::catalog(), plan, ProgramKind::integrate).text;
      const std::string& text = plan.program.text;
      INFO(sampler.name << " " << precision_name(precision));
      ++programs;
      CHECK(text.size() < whole.size());
      if (text.size() * 3 < whole.size() * 2) ++smaller;
      for (const auto& [name, uses] : functions_of(text)) {
        INFO(name);
        CHECK(uses > 1);
      }
      CHECK(open_questions(text) == 0);
      CHECK(names_of(text).count("KOKSMA_EXACT") == 0);
    }
  CHECK(programs > 20);
  CHECK(smaller * 2 > programs);  // a third is left out of most
}

TEST_CASE("a plan's text has scrambling, squares, random numbers and counters where it uses them",
          "[unit]") {
  std::size_t nested = 0, plain = 0;
  for (const Sampler& sampler : test::samplers_by_kernel()) {
    const std::set<std::string> names =
        names_of(plan_to_prune(sampler, test::precisions(sampler).front()).program.text);
    INFO(sampler.name);
    const bool owen = sampler.options.value("randomize", "") == "owen";
    if (sampler.family == "digital") CHECK(names.contains("owen_hash") == owen);
    (owen ? nested : plain) += 1;
    if (sampler.family == "lattice" || sampler.family == "kronecker")
      CHECK_FALSE(names.contains("philox_rounds"));
    const Estimator& estimator = test::catalog().estimator(sampler.default_estimator, "test");
    CHECK(names.contains("squared_term") == (estimator.moments == 2));
    CHECK_FALSE(names.contains("nonfinite_lanes"));
    CHECK_FALSE(names.contains("KOKSMA_COUNTERS"));
  }
  CHECK(nested > 0);
  CHECK(plain > 5);
}

TEST_CASE("tables of nets and lattices grow by one step per doubling of N, from 2^4 on", "[unit]") {
  for (const char* name : {"sobol-shift", "sobol-lms-shift", "lattice-shift"}) {
    const Sampler sampler = test::catalog().sampler(name, "test");
    for (const std::uint32_t dim : {3U, 20U}) {
      const auto words = [&](std::uint64_t n) {
        Plan plan = plan_to_prune(sampler, Precision::fp32);
        plan.request.dim = dim;
        plan.request.end_index = n;
        return build_point_table(plan).size() / 4;
      };
      INFO(name << " d = " << dim);
      const std::size_t one = words(32) - words(16);
      CHECK(words(64) - words(32) == one);
      // A net's step is a word per dimension; a lattice's are two, each with its lanes and a column
      // where the kernel is unrolled.
      const bool lattice = sampler.family == "lattice";
      CHECK(one == std::size_t{dim} * (!lattice ? 1 : dim == 3 ? 33 : 2));
      // Behind a header of 8 words: no column that no index reaches.
      CHECK(words(16) == 8 + std::size_t{dim} * ((lattice ? 32 : 16) + 1));
    }
  }
}
