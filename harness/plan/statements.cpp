#include "plan/statements.hpp"

#include <fmt/format.h>

#include "error/error.hpp"

namespace koksma {
namespace {

class Statements {
 public:
  Statements(std::string_view code, const std::vector<Token>& tokens, const ProgramNames& names)
      : code_(code), tokens_(tokens), names_(names) {}

  std::vector<StatementCounts> take() { return std::move(result_); }

  // Between the braces tokens[begin] and tokens[end].
  void compound(std::size_t begin, std::size_t end) {
    at_ = begin + 1;
    end_ = end;
    while (at_ < end) statement();
    at_ = end + 1;
  }

 private:
  std::string_view peek(std::size_t ahead = 0) const {
    return at_ + ahead < tokens_.size() ? tokens_[at_ + ahead].text : std::string_view();
  }
  std::size_t place() const { return tokens_[at_].at; }
  std::size_t behind_last() const { return tokens_[at_ - 1].at + tokens_[at_ - 1].text.size(); }
  void expect(std::string_view text) {
    if (peek() != text)
      throw UnsupportedError(
          fmt::format("operations: '{}' expected before '{}'", text, code_.substr(place(), 40)));
    ++at_;
  }
  std::size_t closing(std::size_t open) const {
    int depth = 0;
    for (std::size_t i = open; i < tokens_.size(); ++i) {
      const std::string_view t = tokens_[i].text;
      depth += t == "(" || t == "{" || t == "[" ? 1 : t == ")" || t == "}" || t == "]" ? -1 : 0;
      if (depth == 0) return i;
    }
    return tokens_.size() - 1;
  }
  void expression(Counts& counts) {
    at_ = read_expression(code_, tokens_, at_, end_, names_, counts, false);
  }

  bool is_declaration() const {
    const std::string_view t = peek();
    if (t == "const" || t == "typedef" || t == "struct" || t == "volatile" ||
        t.starts_with("__global") || t.starts_with("__private") || t.starts_with("__local"))
      return true;
    return is_type(std::string(t), names_.types) && peek(1) != "(" && peek(1) != ".";
  }

  // [type tokens] name [size] [= value] , …; the counts come behind, where the names are known.
  void declaration() {
    Counts counts;
    if (peek() == "typedef") {
      while (peek() != ";") ++at_;
    }
    while (at_ < end_ && peek() != ";") {
      if (peek() == "=") {
        ++at_;
        at_ = read_expression(code_, tokens_, at_, end_, names_, counts, true);
      } else if (peek() == "[" || peek() == "(") {
        at_ = closing(at_) + 1;
      } else {
        ++at_;
      }
    }
    expect(";");
    if (!counts.empty()) result_.push_back({behind_last(), std::move(counts), false, false});
  }

  // A statement under a condition gets braces, so that counts have a place.
  void controlled(Counts first) {
    if (peek() == "{") {
      const std::size_t end = closing(at_), outer = end_;
      if (!first.empty()) result_.push_back({tokens_[at_].at + 1, std::move(first), false, false});
      compound(at_, end);
      end_ = outer;
      return;
    }
    result_.push_back({place(), std::move(first), true, false});
    statement();
    result_.push_back({behind_last(), {}, false, true});
  }

  // What initialises it runs once and is not counted.
  void loop_for() {
    at_ += 2;
    while (peek() != ";") ++at_;
    ++at_;
    Counts each;
    if (peek() != ";") expression(each);
    expect(";");
    if (peek() != ")") expression(each);
    expect(")");
    controlled(std::move(each));
  }

  void branch() {
    const std::size_t before = place();
    at_ += 2;
    Counts counts;
    expression(counts);
    expect(")");
    if (!counts.empty()) result_.push_back({before, std::move(counts), false, false});
    controlled({});
    if (peek() != "else") return;
    ++at_;
    controlled({});
  }

  void loop_while() {
    at_ += 2;
    Counts each;
    expression(each);
    expect(")");
    controlled(std::move(each));
  }

  void loop_do() {
    ++at_;
    controlled({});
    expect("while");
    at_ = closing(at_) + 1;
    expect(";");
  }

  void statement() {
    const std::string first(peek());
    if (first == ";")
      ++at_;
    else if (first == "{")
      controlled({});
    else if (first == "KOKSMA_UNROLL")
      unrolled(1);
    else if (first == "_Pragma")
      unrolled(closing(at_ + 1) + 1 - at_);
    else if (first == "if")
      branch();
    else if (first == "for")
      loop_for();
    else if (first == "while")
      loop_while();
    else if (first == "do")
      loop_do();
    else if (first == "switch" || first == "goto" || first == "case")
      throw UnsupportedError(fmt::format("operations: can not read '{}'", first));
    else if (is_declaration())
      declaration();
    else
      simple();
  }

  // The pragma stays directly before its loop: a for has nothing that is counted before it.
  void unrolled(std::size_t tokens) {
    at_ += tokens;
    statement();
  }

  void simple() {
    const std::size_t before = place();
    Counts counts;
    if (peek() == "return" || peek() == "break" || peek() == "continue") ++at_;
    if (peek() != ";") expression(counts);
    if (peek() == ";") ++at_;  // a macro may bring its own
    if (!counts.empty()) result_.push_back({before, std::move(counts), false, false});
  }

  std::string_view code_;
  const std::vector<Token>& tokens_;
  const ProgramNames& names_;
  std::size_t at_ = 0, end_ = 0;
  std::vector<StatementCounts> result_;
};

}  // namespace

std::vector<StatementCounts> statement_counts(std::string_view code,
                                              const std::vector<Token>& tokens, std::size_t begin,
                                              std::size_t end, const ProgramNames& names) {
  Statements statements(code, tokens, names);
  statements.compound(begin, end);
  return statements.take();
}

}  // namespace koksma
