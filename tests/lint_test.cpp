// The house rules that a program can check: stages include only what is above them, kernel pieces
// avoid what behaves differently at other widths or precisions, files stay short and finished.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support.hpp"

using namespace koksma;

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kNone;

// The stages in the order of the data (2-architecture).
const std::vector<std::string> kStages{"error",   "catalog",  "study",   "points",    "plan",
                                       "device",  "estimate", "journal", "stability", "film",
                                       "quality", "report",   "cli"};

std::size_t stage_index(const std::string& name) {
  return static_cast<std::size_t>(std::find(kStages.begin(), kStages.end(), name) -
                                  kStages.begin());
}

// Includes of `source`, a file of `stage`, that point to a later stage or to no stage.
std::vector<std::string> wrong_includes(const std::string& stage, const std::string& source) {
  static const std::regex include(R"re(#\s*include\s*"([^"]*)")re");
  std::vector<std::string> wrong;
  for (auto it = std::sregex_iterator(source.begin(), source.end(), include);
       it != std::sregex_iterator(); ++it) {
    const std::string path = (*it)[1];
    const std::size_t index = path.find('/') == std::string::npos
                                  ? kStages.size()
                                  : stage_index(path.substr(0, path.find('/')));
    if (index == kStages.size() || index > stage_index(stage)) wrong.push_back(path);
  }
  return wrong;
}

// Comments become blanks; lines stay.
std::string without_comments(const std::string& source) {
  std::string text = std::regex_replace(source, std::regex(R"(//[^\n]*)"), "");
  static const std::regex block(R"(/\*([^*]|\*(?!/))*\*/)");
  std::smatch found;
  while (std::regex_search(text, found, block)) {
    const std::string comment = found.str();
    text.replace(
        static_cast<std::size_t>(found.position()), comment.size(),
        std::string(static_cast<std::size_t>(std::count(comment.begin(), comment.end(), '\n')),
                    '\n'));
  }
  return text;
}

// What is under #ifdef KOKSMA_EXACT runs in scalar double on the host's CPU: blanked, its #else
// branch kept.
std::string without_exact(const std::string& source) {
  std::istringstream lines(source);
  std::string line, kept;
  std::vector<int> levels;  // per open #if: 1 inside KOKSMA_EXACT, 0 elsewhere
  static const std::regex opens(R"(^\s*#\s*if)"), opens_exact(R"(#\s*ifdef\s+KOKSMA_EXACT\b)");
  static const std::regex turns(R"(^\s*#\s*(else|elif))"), closes(R"(^\s*#\s*endif)");
  while (std::getline(lines, line)) {
    if (std::regex_search(line, opens))
      levels.push_back(std::regex_search(line, opens_exact) ? 1 : 0);
    else if (std::regex_search(line, turns) && !levels.empty())
      levels.back() = 0;
    const bool exact = std::find(levels.begin(), levels.end(), 1) != levels.end();
    if (std::regex_search(line, closes) && !levels.empty()) levels.pop_back();
    kept += (exact ? "" : line) + "\n";
  }
  return kept;
}

constexpr const char* kLiteral =
    R"([-+]?(0[xX][0-9a-fA-F]*\.?[0-9a-fA-F]*([pP][-+]?[0-9]+)?|[0-9]+\.?[0-9]*([eE][-+]?[0-9]+)?|\.[0-9]+([eE][-+]?[0-9]+)?))";

// R(0.5), and the arguments of the piece's own macros that hand one on to R(): macro(x, 0.5).
std::string without_wrapped_literals(std::string text) {
  std::vector<std::string> macros{"R"};
  static const std::regex macro(R"(#\s*define\s+(\w+)\(([^)]*)\)([^\n]*))");
  for (auto it = std::sregex_iterator(text.begin(), text.end(), macro);
       it != std::sregex_iterator(); ++it) {
    const std::string parameters = (*it)[2], body = (*it)[3];
    static const std::regex last(R"((\w+)\s*$)");
    std::smatch found;
    if (std::regex_search(parameters, found, last) &&
        body.find("R(" + found[1].str() + ")") != std::string::npos)
      macros.push_back((*it)[1]);
  }
  for (const std::string& name : macros)
    text = std::regex_replace(
        text, std::regex("\\b" + name + R"(\(([^()]*,)?\s*)" + kLiteral + R"(\s*\))"),
        name + "($1 )");
  return text;
}

// Complaints about a kernel piece, "line: what". `~` is refused on integers too: telling them from
// reals would need a parser, and no piece needs it (x ^ all ones says the same). Integer literals
// are free.
std::vector<std::string> lint_piece(const std::string& source, bool is_sum) {
  const std::string text = without_wrapped_literals(without_exact(without_comments(source)));
  struct Rule {
    std::regex pattern;
    const char* complaint;
    bool in_sums;
  };
  static const std::vector<Rule> rules{
      {std::regex(
           R"((^|[^\w.])([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+[eE][-+]?[0-9]+|[0-9]+\.[0-9]*[eE][-+]?[0-9]+|0[xX][0-9a-fA-F]*\.[0-9a-fA-F]*|0[xX][0-9a-fA-F]+\.?[0-9a-fA-F]*[pP][-+]?[0-9]+)[fF]?($|[^\w.]))"),
       "raw floating literal: write R(...)", true},
      {std::regex(R"(\?)"), "?: is per lane on vectors only: select_real", true},
      {std::regex(R"(\b(any|all|select|isnan|isinf|isfinite)\s*\()"),
       "differs between scalars and vectors: any_lane, all_lanes, select_real, nonfinite_lanes",
       true},
      {std::regex(R"(~)"), "~ on a mask is not ! at width 1: not_lanes", true},
      {std::regex(R"(\b(float|double|half)(2|3|4|8|16)\b)"), "a vector type written out: real",
       true},
      {std::regex(R"(\b(convert_|as_)?(float|double|half)\b)"),
       "a precision written out: real or scalar", false},
      {std::regex(R"(\bfor\s*\(\s*(int|long|size_t)\b)"), "loops run over uint", true},
  };
  std::vector<std::string> complaints;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number)
    for (const Rule& rule : rules)
      if ((rule.in_sums || !is_sum) && std::regex_search(line, rule.pattern))
        complaints.push_back(std::to_string(number) + ": " + rule.complaint);
  return complaints;
}

std::vector<fs::path> files_under(const std::vector<std::string>& folders,
                                  const std::vector<std::string>& extensions) {
  std::vector<fs::path> files;
  for (const std::string& folder : folders) {
    if (!fs::exists(fs::path(KOKSMA_SOURCE_DIR) / folder)) continue;
    for (const auto& file : fs::recursive_directory_iterator(fs::path(KOKSMA_SOURCE_DIR) / folder))
      if (std::find(extensions.begin(), extensions.end(), file.path().extension()) !=
          extensions.end())
        files.push_back(file.path());
  }
  return files;
}

}  // namespace

TEST_CASE("a stage includes only itself and the stages above it", "[unit]") {
  // The check sees what it must.
  CHECK(wrong_includes("plan",
                       "#include \"device/device.hpp\"\n#include <device/x>\n#include "
                       "\"points/tables.hpp\"\n#include \"plan/plan.hpp\"") ==
        std::vector<std::string>{"device/device.hpp"});
  CHECK(wrong_includes(
            "error",
            "# include \"catalog/json.hpp\"\n#include \"local.hpp\"\n#include \"nowhere/x.hpp\"")
            .size() == 3);

  std::set<std::string> seen;
  for (const fs::path& file : files_under({"harness"}, {".cpp", ".hpp"})) {
    const std::string stage = file.parent_path().filename();
    INFO(file.string());
    REQUIRE(stage_index(stage) < kStages.size());
    seen.insert(stage);
    CHECK(wrong_includes(stage, read_text_file(file)) == kNone);
  }
  CHECK(seen.size() >= 9);
}

TEST_CASE("no two headers define a type of the same name: the linker would take either", "[unit]") {
  const auto types_of = [](const std::string& source) {
    static const std::regex definition(R"re((^|\n)(?:struct|class|enum class) (\w+)[^;{\n]*\{)re");
    std::vector<std::string> names;
    for (auto it = std::sregex_iterator(source.begin(), source.end(), definition);
         it != std::sregex_iterator(); ++it)
      names.push_back((*it)[2]);
    return names;
  };
  // The check sees what it must: definitions of the namespace, no declarations and no members.
  CHECK(types_of("struct A {\n  struct B {\n  };\n};\nclass C;\nclass D final : public A {};\n"
                 "enum class E : int { e };\n") == std::vector<std::string>{"A", "D", "E"});

  std::map<std::string, std::string> seen;
  for (const fs::path& file : files_under({"harness"}, {".hpp"}))
    for (const std::string& name : types_of(read_text_file(file))) {
      INFO(name << " in " << file.string() << " and in " << seen[name]);
      CHECK(seen[name].empty());
      seen[name] = file.string();
    }
  CHECK(seen.size() > 50);
}

TEST_CASE(
    "the kernel lint refuses what behaves differently at other widths or precisions, and nothing "
    "else",
    "[unit]") {
  for (const char* bad : {"x * 0.5",
                          "x * .5",
                          "x + 1.",
                          "x + 1.0f",
                          "x * 1e-3",
                          "x * 1E3f",
                          "x * 0x1p-3",
                          "x * 0x1.8p+1",
                          "R(0.5f)",
                          "R(0.5) + 0.25",
                          "a > b ? a : b",
                          "if (any(m)) {}",
                          "while (!all (m)) {}",
                          "~m",
                          "select(a, b, m)",
                          "isnan(x)",
                          "double4 x;",
                          "float16 x;",
                          "double x;",
                          "float x;",
                          "convert_double(x)",
                          "as_float(x)",
                          "for (int i = 0; i < 3; ++i) {}",
                          "#if 1\nx = 0.5;\n#endif",
                          "#ifdef KOKSMA_EXACT\n#else\nx = 0.5;\n#endif",
                          "#ifdef KOKSMA_EXACT\n#if 1\n#endif\n#endif\nx = 0.5;",
                          "#define STEP(a, c) x = fma(x, a, c);\nSTEP(x, 0.5)"}) {
    INFO(bad);
    CHECK(lint_piece(bad, false).size() == 1);
  }
  for (const char* good :
       {"R(0.5)", "R(-1.5e-3)", "R(0x1.8p-3)", "R( .5 )", "x * R(2.0) + R(1)",
        "x >> 9 & 0x9C8E6A1F3D20ADEAUL", "0xE3", "10u", "x1e5", "p->dim++",
        "// 0.5 ~ any(x) ? double", "/* 0.5\n~ */", "any_lane(m)", "select_real(m, a, b)",
        "as_uint(x)", "#ifdef KOKSMA_EXACT\ndouble x = a ? 0.5 : ~1;\n#endif",
        "#ifdef KOKSMA_EXACT\n#if 1\ndouble x;\n#endif\ndouble y;\n#else\nreal x;\n#endif",
        "#define STEP(a, c) x = fma(x, a, R(c));\nSTEP(r, 0.5)",
        "for (uint j = 0; j < 3; ++j) {}"}) {
    INFO(good);
    CHECK(lint_piece(good, false) == kNone);
  }
  CHECK(lint_piece("double x;", true).empty());
  CHECK(lint_piece("double4 x;", true).size() == 1);
  CHECK(lint_piece("\n\nx = 0.5;", false)[0].starts_with("3: "));
}

TEST_CASE("kernel pieces write no raw literals, no ?:, any, all or ~, and no precision or width",
          "[unit]") {
  std::size_t pieces = 0;
  for (const fs::path& file : files_under({"kernels/general", "kernels/points", "kernels/solvers",
                                           "kernels/sums", "kernels/transforms", "integrands"},
                                          {".cl"})) {
    ++pieces;
    INFO(file.string());
    CHECK(lint_piece(read_text_file(file), file.parent_path().filename() == "sums") == kNone);
  }
  CHECK(pieces >= 20);
}

TEST_CASE("source files have at most 400 lines and are finished", "[unit]") {
  // Spelt apart, or this file would find itself.
  const std::regex unfinished(
      "\\b(TO"
      "DO|FIX"
      "ME|XX"
      "X)\\b");
  std::size_t checked = 0;
  for (const fs::path& file :
       files_under({"harness", "tests", "kernels", "integrands", "scripts"},
                   {".cpp", ".hpp", ".cl", ".py", ".sh", ".cmake", ".txt"})) {
    ++checked;
    const std::string text = read_text_file(file);
    INFO(file.string());
    CHECK(std::count(text.begin(), text.end(), '\n') <= 400);
    CHECK_FALSE(std::regex_search(text, unfinished));
  }
  CHECK(checked > 80);
}
