// Tokens of OpenCL C: what pruning and instrumenting read.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace koksma {

struct Token {
  enum class Kind { identifier, number, text, punctuation };
  Kind kind = Kind::punctuation;
  std::string_view text;
  std::size_t at = 0;  // in the text that was read
};

// Of one text without its comments. Directives are not recognised: # is punctuation. Operators of
// several characters are one token.
std::vector<Token> tokens_of(std::string_view text);

}  // namespace koksma
