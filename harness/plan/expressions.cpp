#include "plan/expressions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "error/error.hpp"

namespace koksma {
namespace {

// What an operator is counted as.
std::string operation_of(std::string_view op) {
  static const std::map<std::string_view, std::string> kNames = {
      {"+", "add"},      {"-", "add"},      {"*", "multiply"}, {"/", "divide"},   {"%", "divide"},
      {"&", "bitwise"},  {"|", "bitwise"},  {"^", "bitwise"},  {"~", "bitwise"},  {"<<", "shift"},
      {">>", "shift"},   {"<", "compare"},  {">", "compare"},  {"<=", "compare"}, {">=", "compare"},
      {"==", "compare"}, {"!=", "compare"}, {"&&", "compare"}, {"||", "compare"}, {"!", "compare"},
      {"++", "add"},     {"--", "add"},     {"?", "select"}};
  const auto found = kNames.find(op);
  return found == kNames.end() ? "" : found->second;
}

int binary_precedence(std::string_view op) {
  static const std::map<std::string_view, int> kPrecedence = {
      {"*", 10}, {"/", 10}, {"%", 10}, {"+", 9},  {"-", 9},  {"<<", 8},
      {">>", 8}, {"<", 7},  {">", 7},  {"<=", 7}, {">=", 7}, {"==", 6},
      {"!=", 6}, {"&", 5},  {"^", 4},  {"|", 3},  {"&&", 2}, {"||", 1}};
  const auto found = kPrecedence.find(op);
  return found == kPrecedence.end() ? 0 : found->second;
}

bool is_assignment(std::string_view op) {
  return op == "=" ||
         (op.size() >= 2 && op.back() == '=' && binary_precedence(op) == 0 && op != "==");
}

// Calls that are no operation: other views of the same bits, literals, the counts themselves.
bool is_free(std::string_view name) {
  return name == "R" || name == "sizeof" || name.starts_with("as_") ||
         name.starts_with("KOKSMA_AS_") || name.starts_with("KOKSMA_COUNT") ||
         name.starts_with("KOKSMA_OTHER_OF");
}

std::string builtin_of(std::string_view name) {
  if (name.starts_with("convert_") || name.starts_with("KOKSMA_TO_") || name.ends_with("WORDS32"))
    return "convert";
  return name == "load_lanes" ? "load" : std::string(name);
}

// Expressions by precedence climbing; every operation goes to `counts` with its slice of the code.
class Expressions {
 public:
  Expressions(std::string_view code, const std::vector<Token>& tokens, std::size_t at,
              std::size_t end, const ProgramNames& names, Counts& counts, int depth)
      : code_(code),
        tokens_(tokens),
        at_(at),
        end_(end),
        names_(names),
        counts_(counts),
        depth_(depth) {}

  std::size_t at() const { return at_; }

  void comma() {
    assignment();
    while (take(",")) assignment();
  }

  void assignment() {
    const std::size_t begin = at_;
    ternary();
    if (!is_assignment(peek())) return;
    const std::string op(peek());
    if (op != "=")
      count(operation_of(std::string_view(op).substr(0, op.size() - 1)), slice(begin, at_));
    ++at_;
    initialiser();
  }

  // What may stand behind =.
  void initialiser() {
    if (!take("{")) return assignment();
    while (!take("}")) {
      initialiser();
      take(",");
      if (at_ >= end_) fail();
    }
  }

 private:
  std::string_view peek(std::size_t ahead = 0) const {
    return at_ + ahead < end_ ? tokens_[at_ + ahead].text : std::string_view();
  }
  bool take(std::string_view text) {
    if (peek() != text) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void fail() const {
    const std::size_t from = at_ < tokens_.size() ? tokens_[at_].at : 0;
    throw UnsupportedError(fmt::format("operations: can not read '{}'", code_.substr(from, 40)));
  }
  std::string slice(std::size_t begin, std::size_t end) const {
    const Token& last = tokens_[end - 1];
    return std::string(
        code_.substr(tokens_[begin].at, last.at + last.text.size() - tokens_[begin].at));
  }
  void count(const std::string& operation, std::string expression) {
    if (!operation.empty()) counts_.push_back({operation, std::move(expression)});
  }

  void ternary() {
    const std::size_t begin = at_;
    binary(1);
    if (!take("?")) return;
    comma();
    if (!take(":")) fail();
    ternary();
    count("select", slice(begin, at_));
  }

  void binary(int least) {
    const std::size_t begin = at_;
    unary();
    for (int p = binary_precedence(peek()); p >= least; p = binary_precedence(peek())) {
      const std::string op(peek());
      ++at_;
      binary(p + 1);
      count(operation_of(op), slice(begin, at_));
    }
  }

  void unary() {
    const std::string op(peek());
    if (op == "++" || op == "--") {
      ++at_;
      const std::size_t begin = at_;
      unary();
      count("add", slice(begin, at_));
    } else if (op == "-" || op == "!" || op == "~") {
      const std::size_t begin = at_++;
      // The sign of a literal is part of it.
      const bool literal = at_ < end_ && tokens_[at_].kind == Token::Kind::number;
      unary();
      if (!literal) count(operation_of(op), slice(begin, at_));
    } else if (op == "+" || op == "*" || op == "&") {
      ++at_;
      unary();
    } else if (op == "(" && is_cast()) {
      skip_brackets();
      unary();
    } else {
      postfix();
    }
  }

  // `(`, names of types, qualifiers and stars, `)`, and an operand.
  bool is_cast() const {
    bool type = false;
    for (std::size_t k = 1; at_ + k < end_; ++k) {
      const std::string_view t = peek(k);
      if (t == ")") return type;
      if (is_type(std::string(t), names_.types))
        type = true;
      else if (t != "*" && t != "const" && !t.starts_with("__"))
        return false;
    }
    return false;
  }

  void skip_brackets() {
    int depth = 0;
    do {
      const std::string_view t = peek();
      depth += t == "(" || t == "[" || t == "{" ? 1 : t == ")" || t == "]" || t == "}" ? -1 : 0;
      ++at_;
    } while (depth > 0 && at_ < end_);
  }

  void postfix() {
    const std::size_t begin = at_;
    if (take("(")) {
      comma();
      if (!take(")")) fail();
    } else if (peek(1) == "(" && tokens_[at_].kind == Token::Kind::identifier) {
      call();
    } else if (at_ < end_ && tokens_[at_].kind != Token::Kind::punctuation) {
      ++at_;
    } else {
      fail();
    }
    while (true) {
      if (peek() == "." || peek() == "->") {
        at_ += 2;
      } else if (take("[")) {
        comma();
        if (!take("]")) fail();
        count("element", slice(begin, at_));
      } else if (peek() == "++" || peek() == "--") {
        count("add", slice(begin, at_));
        ++at_;
      } else {
        return;
      }
    }
  }

  void call() {
    const std::size_t begin = at_;
    const std::string name(tokens_[at_++].text);
    if (name == "sizeof" || name == "R") return skip_brackets();
    if (name == "KOKSMA_PASTE") return pasted_call(begin);
    const auto macro = names_.macros.find(name);
    if (macro != names_.macros.end()) return expand(macro->second);
    ++at_;
    if (peek() != ")") comma();
    if (!take(")")) fail();
    if (names_.calls.contains(name) || is_free(name)) return;
    const bool stores = name == "store_lanes" || name.starts_with("vstore");
    count(stores ? "store" : builtin_of(name), stores ? "" : slice(begin, at_));
  }

  // KOKSMA_PASTE(convert_double, 16)(y): the name is made of the first word and the others.
  void pasted_call(std::size_t begin) {
    std::size_t word = begin;
    while (word + 2 < end_ && tokens_[word].text == "KOKSMA_PASTE") word += 2;
    const std::string operation = builtin_of(tokens_[word].text);
    skip_brackets();
    if (!take("(")) return;
    comma();
    if (!take(")")) fail();
    if (!is_free(operation)) count(operation, slice(begin, at_));
  }

  // The operations of the macro's body, its arguments in their places; each argument is read as
  // often as the body names it.
  void expand(const Macro& macro);

  std::string_view code_;
  const std::vector<Token>& tokens_;
  std::size_t at_, end_;
  const ProgramNames& names_;
  Counts& counts_;
  int depth_;
};

void Expressions::expand(const Macro& macro) {
  constexpr int kDeepest = 16;
  if (depth_ > kDeepest) fail();
  std::vector<std::string> arguments;
  std::size_t from = at_ + 1;
  int brackets = 0;
  for (; at_ < end_; ++at_) {
    const std::string_view t = peek();
    brackets += t == "(" ? 1 : t == ")" ? -1 : 0;
    if ((t == "," && brackets == 1) || brackets == 0) {
      arguments.push_back(from < at_ ? slice(from, at_) : "");
      from = at_ + 1;
    }
    if (brackets == 0) break;
  }
  ++at_;
  std::string body;
  std::size_t copied = 0;
  for (const Token& token : tokens_of(macro.body)) {
    const auto found = std::find(macro.parameters.begin(), macro.parameters.end(), token.text);
    if (found == macro.parameters.end()) continue;
    body += macro.body.substr(copied, token.at - copied);
    body += arguments.at(static_cast<std::size_t>(found - macro.parameters.begin()));
    copied = token.at + token.text.size();
  }
  body += macro.body.substr(copied);
  const std::vector<Token> tokens = tokens_of(body);
  if (tokens.empty()) return;
  std::size_t end = tokens.size();
  while (end > 0 && tokens[end - 1].text == ";") --end;
  Expressions inner(body, tokens, 0, end, names_, counts_, depth_ + 1);
  inner.comma();
  if (inner.at() != end) fail();
}

}  // namespace

bool is_type(const std::string& name, const std::set<std::string>& types) {
  static const std::regex kBuiltin(
      R"((u?(char|short|int|long)|float|double|half)(2|3|4|8|16)?|size_t|void|bool)");
  return types.contains(name) || std::regex_match(name, kBuiltin);
}

std::size_t read_expression(std::string_view code, const std::vector<Token>& tokens, std::size_t at,
                            std::size_t end, const ProgramNames& names, Counts& counts,
                            bool initialiser) {
  Expressions expressions(code, tokens, at, end, names, counts, 0);
  if (initialiser)
    expressions.initialiser();
  else
    expressions.comma();
  return expressions.at();
}

}  // namespace koksma
