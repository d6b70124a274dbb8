#include "plan/tokens.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace koksma {
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Longer operators come first.
constexpr std::array<std::string_view, 24> kOperators = {
    "<<=", ">>=", "...", "##", "->", "++", "--", "<<", ">>", "<=", ">=", "==",
    "!=",  "&&",  "||",  "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "::"};

std::size_t end_of_comment(std::string_view text, std::size_t at) {
  if (text.substr(at, 2) == "//") return std::min(text.find('\n', at), text.size());
  const std::size_t end = text.find("*/", at + 2);
  return end == std::string_view::npos ? text.size() : end + 2;
}

// Numbers with their suffixes and exponents; 1.0e-3f and 0x1.8p-2 are one token.
std::size_t end_of_number(std::string_view text, std::size_t at) {
  const bool hexadecimal = text.substr(at, 2) == "0x" || text.substr(at, 2) == "0X";
  std::size_t end = at;
  while (end < text.size()) {
    const char before = end > at ? text[end - 1] : ' ';
    const bool exponent =
        hexadecimal ? before == 'p' || before == 'P' : before == 'e' || before == 'E';
    const bool sign = (text[end] == '+' || text[end] == '-') && exponent;
    if (!is_word(text[end]) && text[end] != '.' && !sign) break;
    ++end;
  }
  return end;
}

std::size_t end_of_text(std::string_view text, std::size_t at) {
  std::size_t end = at + 1;
  while (end < text.size() && text[end] != text[at]) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

}  // namespace

std::vector<Token> tokens_of(std::string_view text) {
  using Kind = Token::Kind;
  std::vector<Token> tokens;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const std::string_view two = text.substr(at, 2);
    if (two == "//" || two == "/*") {
      at = end_of_comment(text, at);
      continue;
    }
    if (std::isspace(static_cast<unsigned char>(c)) != 0 || c == '\\') {
      ++at;
      continue;
    }
    Kind kind = Kind::punctuation;
    std::size_t end = at + 1;
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (digit ||
        (c == '.' && two.size() == 2 && std::isdigit(static_cast<unsigned char>(two[1])) != 0)) {
      kind = Kind::number;
      end = end_of_number(text, at);
    } else if (is_word(c)) {
      kind = Kind::identifier;
      while (end < text.size() && is_word(text[end])) ++end;
    } else if (c == '"' || c == '\'') {
      kind = Kind::text;
      end = end_of_text(text, at);
    } else {
      for (const std::string_view op : kOperators)
        if (text.substr(at, op.size()) == op) {
          end = at + op.size();
          break;
        }
    }
    tokens.push_back({kind, text.substr(at, end - at), at});
    at = end;
  }
  return tokens;
}

}  // namespace koksma
