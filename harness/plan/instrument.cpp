#include "plan/instrument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "error/error.hpp"
#include "plan/compose.hpp"
#include "plan/conditionals.hpp"
#include "plan/statements.hpp"
#include "plan/tokens.hpp"

namespace koksma {
namespace {

constexpr const char* kParameter = "koksma_counted *koksma_counting";
constexpr const char* kArgument = "koksma_counting";

// The text with directives blanked, so that what is left is code, each at its place.
std::string code_of(const std::string& text) {
  std::string code = text;
  bool continues = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    if (continues || !directive_of(line).empty()) {
      std::fill(code.begin() + static_cast<std::ptrdiff_t>(at),
                code.begin() + static_cast<std::ptrdiff_t>(end), ' ');
      continues = line.ends_with('\\');
    }
    at = end + 1;
  }
  return code;
}

// Functions that the program defines: where each name and its body are among the tokens.
struct Function {
  std::size_t name = 0, body = 0;  // body: of its `{`; 0: a declaration
  bool is_kernel = false;
};

std::size_t closing(const std::vector<Token>& tokens, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    const std::string_view t = tokens[i].text;
    depth += t == "(" || t == "{" || t == "[" ? 1 : t == ")" || t == "}" || t == "]" ? -1 : 0;
    if (depth == 0) return i;
  }
  throw UnsupportedError("operations: brackets that do not match");
}

std::vector<Function> functions_of(const std::vector<Token>& tokens) {
  std::vector<Function> functions;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    bool is_static = false, is_kernel = false;
    std::size_t k = i;
    for (; k < tokens.size() && tokens[k].text != ";" && tokens[k].text != "{"; ++k) {
      if (tokens[k].text == "__attribute__") {
        k = closing(tokens, k + 1);
      } else if (tokens[k].text == "(") {
        const std::size_t after = closing(tokens, k) + 1;
        const bool body = after < tokens.size() && tokens[after].text == "{";
        if (is_static || is_kernel) functions.push_back({k - 1, body ? after : 0, is_kernel});
        k = after;
        break;
      } else {
        is_static = is_static || tokens[k].text == "static";
        is_kernel = is_kernel || tokens[k].text == "__kernel";
      }
    }
    // Past the declaration: its body, its `;`, or the braces of a type and the `;` behind them.
    while (k < tokens.size() && tokens[k].text != ";" && tokens[k].text != "{") ++k;
    if (k < tokens.size() && tokens[k].text == "{") {
      const bool is_function = k > i && tokens[k - 1].text == ")";
      k = closing(tokens, k);
      while (!is_function && k < tokens.size() && tokens[k].text != ";") ++k;
    }
    i = k;
  }
  return functions;
}

class Instrumenter {
 public:
  Instrumenter(const std::string& text, std::vector<std::string>& operations)
      : text_(text), code_(code_of(text)), tokens_(tokens_of(code_)), operations_(operations) {}

  std::string run() {
    const std::vector<Function> functions = functions_of(tokens_);
    for (const Function& f : functions)
      if (!f.is_kernel) names_.calls.insert(std::string(tokens_[f.name].text));
    read_directives();
    read_types();
    for (const Function& f : functions) {
      if (!f.is_kernel) add_parameter(f);
      if (f.body != 0 && !f.is_kernel) count_body(f);
    }
    add_arguments(tokens_, 0, places_of(functions));
    return edited();
  }

 private:
  static std::set<std::size_t> places_of(const std::vector<Function>& functions) {
    std::set<std::size_t> places;
    for (const Function& f : functions) places.insert(f.name);
    return places;
  }

  void insert(std::size_t at, std::string what) { inserts_.emplace(at, std::move(what)); }

  // Macros, other names of functions, and the calls in macros' bodies.
  void read_directives() {
    for (std::size_t at = 0; at < text_.size();) {
      std::size_t end = std::min(text_.find('\n', at), text_.size());
      std::string_view line = std::string_view(text_).substr(at, end - at);
      if (directive_of(line) == "define") {
        while (line.ends_with('\\') && end < text_.size()) {
          end = std::min(text_.find('\n', end + 1), text_.size());
          line = std::string_view(text_).substr(at, end - at);
        }
        defines_.emplace_back(line);
        starts_.push_back(at);
      }
      at = end + 1;
    }
    for (const std::string_view line : defines_) read_macro(line);
    for (std::size_t i = 0; i < defines_.size(); ++i)
      add_arguments(tokens_of(defines_[i]), starts_[i], {});
  }

  void read_macro(std::string_view line) {
    const std::string_view operand = operand_of(line);
    const std::vector<Token> tokens = tokens_of(operand);
    if (tokens.empty()) return;
    const std::string name(tokens[0].text);
    if (tokens.size() > 1 && tokens[1].text == "(" && tokens[1].at == name.size()) {
      Macro macro;
      std::size_t i = 2;
      for (; i < tokens.size() && tokens[i].text != ")"; ++i)
        if (tokens[i].text != ",") macro.parameters.emplace_back(tokens[i].text);
      macro.body = operand.substr(tokens[std::min(i, tokens.size() - 1)].at + 1);
      // What pastes is the prelude's: types, reinterpretations, loads.
      if (macro.body.find("##") == std::string::npos &&
          macro.body.find("KOKSMA_PASTE") == std::string::npos && !name.starts_with("KOKSMA_COUNT"))
        names_.macros.emplace(name, std::move(macro));
    } else if (tokens.size() == 2 && names_.calls.contains(std::string(tokens[1].text))) {
      names_.calls.insert(name);
    } else if (tokens.size() == 2 && names_.calls.contains(name)) {
      names_.calls.insert(std::string(tokens[1].text));
    } else if (tokens.size() == 2) {
      aliases_.emplace(name, tokens[1].text);
    }
  }

  void read_types() {
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      if (tokens_[i].text != "typedef") continue;
      std::size_t end = i;
      int depth = 0;
      for (; end < tokens_.size() && !(depth == 0 && tokens_[end].text == ";"); ++end)
        depth += tokens_[end].text == "{" ? 1 : tokens_[end].text == "}" ? -1 : 0;
      std::size_t last = i;
      for (std::size_t k = i; k < end && tokens_[k].text != "["; ++k)
        if (tokens_[k].kind == Token::Kind::identifier) last = k;
      // Several names of one declaration: typedef real a, b;
      for (std::size_t k = last; k > i && names_.types.insert(std::string(tokens_[k].text)).second;
           k -= 2)
        if (tokens_[k - 1].text != ",") break;
      i = end;
    }
    for (const auto& [name, target] : aliases_)
      if (is_type(target, names_.types)) names_.types.insert(name);
  }

  void add_parameter(const Function& f) {
    const Token& open = tokens_[f.name + 1];
    const Token& next = tokens_[f.name + 2];
    if (next.text == "void" && tokens_[f.name + 3].text == ")") {
      insert(open.at + 1, kParameter);
      erased_.insert(next.at);
    } else {
      insert(open.at + 1, next.text == ")" ? kParameter : fmt::format("{}, ", kParameter));
    }
  }

  // Every call of a function of the program hands the counts on.
  void add_arguments(const std::vector<Token>& tokens, std::size_t offset,
                     const std::set<std::size_t>& but) {
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
      if (tokens[i + 1].text != "(" || !names_.calls.contains(std::string(tokens[i].text)) ||
          but.contains(i))
        continue;
      insert(offset + tokens[i + 1].at + 1,
             tokens[i + 2].text == ")" ? kArgument : fmt::format("{}, ", kArgument));
    }
  }

  void count_body(const Function& f) {
    const std::size_t end = closing(tokens_, f.body);
    for (const StatementCounts& c : statement_counts(code_, tokens_, f.body, end, names_)) {
      std::string text = c.opens ? "{ " : "";
      for (const Counted& one : c.counted) text += count_of(one);
      if (c.closes) text += " }";
      insert(c.at, " " + text + " ");
    }
  }

  std::string count_of(const Counted& one) {
    const auto found = std::find(operations_.begin(), operations_.end(), one.operation);
    const auto place = found - operations_.begin();
    if (found == operations_.end()) operations_.push_back(one.operation);
    const std::string expression = with_arguments(one.expression);
    if (expression.empty()) return fmt::format("KOKSMA_COUNT_ALWAYS({});", place);
    return fmt::format("{}({}, ({}));", place == 1 ? "KOKSMA_COUNT_ELEMENT" : "KOKSMA_COUNT", place,
                       expression);
  }

  // A slice of the code as it will read once arguments are added.
  std::string with_arguments(const std::string& expression) const {
    const std::vector<Token> tokens = tokens_of(expression);
    std::string text;
    std::size_t from = 0;
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
      if (tokens[i + 1].text != "(" || !names_.calls.contains(std::string(tokens[i].text)))
        continue;
      const std::size_t at = tokens[i + 1].at + 1;
      text += expression.substr(from, at - from);
      text += tokens[i + 2].text == ")" ? kArgument : fmt::format("{}, ", kArgument);
      from = at;
    }
    text += expression.substr(from);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  std::string edited() const {
    std::string result;
    std::size_t from = 0;
    for (const auto& [at, what] : inserts_) {
      result += piece(from, at) + what;
      from = at;
    }
    return result + piece(from, text_.size());
  }
  // `void` of an empty list of parameters is left out.
  std::string piece(std::size_t from, std::size_t end) const {
    std::string part = text_.substr(from, end - from);
    const auto erased = erased_.lower_bound(from);
    if (erased != erased_.end() && *erased < end) part.replace(*erased - from, 4, "    ");
    return part;
  }

  const std::string& text_;
  std::string code_;
  std::vector<Token> tokens_;
  std::vector<std::string>& operations_;
  ProgramNames names_;
  std::vector<std::string_view> defines_;
  std::vector<std::size_t> starts_;
  std::map<std::string, std::string> aliases_;
  std::multimap<std::size_t, std::string> inserts_;
  std::set<std::size_t> erased_;
};

}  // namespace

std::string instrumented(const std::string& text, std::vector<std::string>& operations) {
  return Instrumenter(text, operations).run();
}

InstrumentedProgram counting_operations(const Catalog& catalog, const Plan& plan) {
  InstrumentedProgram result;
  result.operations = {"scalar", "element"};
  Plan counted = plan;
  counted.counters = false;
  result.source = compose(catalog, counted, ProgramKind::count);
  const std::string text = instrumented(result.source.text, result.operations);
  std::string head =
      fmt::format("#define KOKSMA_COUNTED_OPERATIONS {}\n#define KOKSMA_COUNTED_SCALAR 0\n",
                  result.operations.size());
  std::size_t slot = 0;
  for (const char* name : kCountedSlots) {
    std::string upper(name);
    for (char& c : upper) c = static_cast<char>(c - 'a' + 'A');
    head += fmt::format("#define KOKSMA_COUNTED_{} {}\n", upper, slot++);
  }
  head += fmt::format("#define KOKSMA_COUNTED_SLOTS {}\n", slot);
  result.source.text = head + counting_types() + text;
  return result;
}

}  // namespace koksma
