#include "plan/conditionals.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "plan/tokens.hpp"

namespace koksma {
namespace {

struct Operator {
  std::string_view text;
  int precedence;  // C99, 6.5.5 to 6.5.14
};
constexpr std::array<Operator, 18> kBinary = {{{"*", 10},
                                               {"/", 10},
                                               {"%", 10},
                                               {"+", 9},
                                               {"-", 9},
                                               {"<<", 8},
                                               {">>", 8},
                                               {"<", 7},
                                               {">", 7},
                                               {"<=", 7},
                                               {">=", 7},
                                               {"==", 6},
                                               {"!=", 6},
                                               {"&", 5},
                                               {"^", 4},
                                               {"|", 3},
                                               {"&&", 2},
                                               {"||", 1}}};

int precedence_of(std::string_view op) {
  for (const Operator& o : kBinary)
    if (o.text == op) return o.precedence;
  return 0;
}

// nullopt where the operation is not defined.
std::optional<long long> apply(std::string_view op, long long a, long long b) {
  if (op == "||") return a != 0 || b != 0 ? 1 : 0;
  if (op == "&&") return a != 0 && b != 0 ? 1 : 0;
  if (op == "==") return a == b ? 1 : 0;
  if (op == "!=") return a != b ? 1 : 0;
  if (op == "<") return a < b ? 1 : 0;
  if (op == ">") return a > b ? 1 : 0;
  if (op == "<=") return a <= b ? 1 : 0;
  if (op == ">=") return a >= b ? 1 : 0;
  if (op == "+") return a + b;
  if (op == "-") return a - b;
  if (op == "*") return a * b;
  if ((op == "/" || op == "%") && b != 0) return op == "/" ? a / b : a % b;
  return std::nullopt;
}

// A condition by precedence climbing. What is not known makes the whole condition unknown, also in
// an operand that would not be evaluated.
class Condition {
 public:
  Condition(std::string_view text, const Macros& macros, int depth)
      : tokens_(tokens_of(text)), macros_(macros), depth_(depth) {}

  std::optional<long long> value() {
    const auto result = binary(1);
    return at_ == tokens_.size() ? result : std::nullopt;
  }

 private:
  std::string_view peek() const { return at_ < tokens_.size() ? tokens_[at_].text : ""; }
  bool take(std::string_view text) {
    if (peek() != text) return false;
    ++at_;
    return true;
  }

  std::optional<long long> binary(int least) {
    auto left = unary();
    while (left && precedence_of(peek()) >= least) {
      const std::string_view op = tokens_[at_++].text;
      const auto right = binary(precedence_of(op) + 1);
      left = right ? apply(op, *left, *right) : std::nullopt;
    }
    return left;
  }

  std::optional<long long> unary() {
    if (take("!")) {
      const auto value = unary();
      return value ? std::optional<long long>(*value == 0 ? 1 : 0) : std::nullopt;
    }
    if (take("-")) {
      const auto value = unary();
      return value ? std::optional<long long>(-*value) : std::nullopt;
    }
    if (take("(")) {
      const auto value = binary(1);
      return take(")") ? value : std::nullopt;
    }
    if (at_ == tokens_.size()) return std::nullopt;
    const Token token = tokens_[at_++];
    if (token.kind == Token::Kind::number) return number(token.text);
    if (token.kind != Token::Kind::identifier) return std::nullopt;
    return token.text == "defined" ? is_defined() : named(token.text);
  }

  static std::optional<long long> number(std::string_view text) {
    long long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
  }

  std::optional<long long> is_defined() {
    const bool bracketed = take("(");
    if (at_ == tokens_.size()) return std::nullopt;
    const std::string_view name = tokens_[at_++].text;
    if (bracketed && !take(")")) return std::nullopt;
    const auto macro = macros_.find(name);
    if (macro == macros_.end())
      return name.starts_with("KOKSMA_") ? std::optional<long long>(0) : std::nullopt;
    return macro->second ? std::optional<long long>(1) : std::nullopt;
  }

  std::optional<long long> named(std::string_view name) const {
    const auto macro = macros_.find(name);
    if (macro == macros_.end())
      return name.starts_with("KOKSMA_") ? std::optional<long long>(0) : std::nullopt;
    constexpr int kDeepest = 16;  // a macro that contains itself
    if (!macro->second || depth_ >= kDeepest) return std::nullopt;
    return Condition(*macro->second, macros_, depth_ + 1).value();
  }

  std::vector<Token> tokens_;
  const Macros& macros_;
  int depth_;
  std::size_t at_ = 0;
};

// One #if … #endif. `decided`: its directives go; `open`: lines of the present branch stay;
// `done`: a branch was open already.
struct Branch {
  bool decided = false, open = true, done = false;
};

void define(Macros& macros, std::string_view operand, bool certain) {
  const std::vector<Token> tokens = tokens_of(operand);
  if (tokens.empty()) return;
  const std::size_t end = tokens[0].at + tokens[0].text.size();
  const bool function_like = end < operand.size() && operand[end] == '(';
  auto& body = macros[std::string(tokens[0].text)];
  // The bracket of a function-like macro is no expression: defined, its value not known.
  body = certain ? std::optional(std::string(function_like ? "(" : operand.substr(end)))
                 : std::nullopt;
}

// A line with those that continue it: a directive, or a line of code.
using Span = std::span<const SourceLine>;

class Opening {
 public:
  // `text`: the lines as one.
  void read(Span lines, std::string_view text) {
    const std::string_view directive = directive_of(text);
    if (directive == "if" || directive == "ifdef" || directive == "ifndef")
      begin(directive, lines, text);
    else if (directive == "elif" && !branches_.empty())
      next(condition_value(operand_of(text), macros_), lines);
    else if (directive == "else" && !branches_.empty())
      next(1, lines);
    else if (directive == "endif" && !branches_.empty())
      end(lines);
    else if (open())
      keep(directive, lines, text);
  }
  std::vector<SourceLine> take() { return std::move(lines_); }

 private:
  bool open() const {
    return std::all_of(branches_.begin(), branches_.end(), [](const Branch& b) { return b.open; });
  }
  bool certain() const {
    return std::all_of(branches_.begin(), branches_.end(),
                       [](const Branch& b) { return b.decided; });
  }

  void put(Span lines) { lines_.insert(lines_.end(), lines.begin(), lines.end()); }

  void begin(std::string_view directive, Span lines, std::string_view text) {
    if (!open()) {
      branches_.push_back({true, false, true});
      return;
    }
    std::string condition(operand_of(text));
    if (directive != "if") condition = "defined(" + condition + ")";
    if (directive == "ifndef") condition = "!" + condition;
    const auto value = condition_value(condition, macros_);
    branches_.push_back({value.has_value(), !value || *value != 0, value && *value != 0});
    if (!value) put(lines);
  }

  // An #elif that is not known, behind closed branches, would have to become an #if: rare enough to
  // leave it to the compiler, with `#if 1` or `#if 0` in place of what was decided.
  void next(std::optional<long long> value, Span lines) {
    Branch& branch = branches_.back();
    if (!branch.decided) {
      put(lines);
      return;
    }
    branch.open = !branch.done && (!value || *value != 0);
    if (branch.open && !value) {
      branch.decided = false;
      lines_.push_back({"#if 0", lines.front().path, lines.front().number});
      put(lines);
    }
    branch.done = branch.done || branch.open;
  }

  void end(Span lines) {
    if (!branches_.back().decided) put(lines);
    branches_.pop_back();
  }

  void keep(std::string_view directive, Span lines, std::string_view text) {
    if (directive == "define") define(macros_, operand_of(text), certain());
    if (directive == "undef") {
      const std::string name(operand_of(text));
      if (certain())
        macros_.erase(name);
      else
        macros_[name] = std::nullopt;
    }
    put(lines);
  }

  Macros macros_;
  std::vector<Branch> branches_;
  std::vector<SourceLine> lines_;
};

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

}  // namespace

std::string_view directive_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('#')) return "";
  line = trimmed(line.substr(1));
  return line.substr(0, line.find_first_of(" \t("));
}

std::string_view operand_of(std::string_view line) {
  const std::string_view directive = directive_of(line);
  const auto begin = static_cast<std::size_t>(directive.data() - line.data()) + directive.size();
  const std::string_view rest = line.substr(begin);
  return trimmed(rest.substr(0, rest.find("//")));
}

std::optional<long long> condition_value(std::string_view condition, const Macros& macros) {
  return Condition(condition, macros, 0).value();
}

std::vector<SourceLine> source_lines(std::string_view text) {
  std::vector<SourceLine> lines;
  std::string path;
  std::size_t number = 1;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with("#line 1 \"")) {
      path = line.substr(9, line.rfind('"') - 9);
      number = 1;
    } else {
      lines.push_back({line, path, number++});
    }
    at = end + 1;
  }
  return lines;
}

std::vector<SourceLine> open_lines(const std::vector<SourceLine>& lines) {
  Opening opening;
  for (std::size_t i = 0; i < lines.size();) {
    std::size_t end = i + 1;
    std::string text(lines[i].text);
    while (text.ends_with('\\') && !directive_of(text).empty() && end < lines.size()) {
      text.back() = ' ';
      text += lines[end++].text;
    }
    opening.read(Span(lines).subspan(i, end - i), text);
    i = end;
  }
  return opening.take();
}

}  // namespace koksma
