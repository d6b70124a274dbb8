#include "plan/prune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "plan/conditionals.hpp"
#include "plan/tokens.hpp"

namespace koksma {
namespace {

using Lines = std::vector<SourceLine>;
constexpr const char* kPaste = "KOKSMA_PASTE";  // pastes its arguments (prelude.cl)

// A declaration or a directive: lines first … last of the program, comments above it included.
struct Item {
  std::size_t first = 0, last = 0;
  std::string name;        // of a function or macro that may be dropped; empty: it stays
  bool directive = false;  // else code; a directive may lie within the lines of a function
  std::vector<std::string> uses, prefixes;
  std::string alias;  // of a macro that is another name for this one
  bool reached = false;
};

std::size_t bytes_of(const Lines& lines) {
  std::size_t bytes = 0;
  for (const SourceLine& line : lines) bytes += line.text.size() + 1;
  return bytes;
}

// What the tokens name, and what begins a name that is pasted.
void note_uses(Item& item, const std::vector<Token>& tokens, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    if (tokens[i].kind != Token::Kind::identifier) continue;
    const bool pasted =
        (i + 1 < end && tokens[i + 1].text == "##") ||
        (i >= begin + 2 && tokens[i - 1].text == "(" && tokens[i - 2].text == kPaste);
    (pasted ? item.prefixes : item.uses).emplace_back(tokens[i].text);
  }
}

// A directive; of `#define NAME body` with what the body uses but its own parameters.
Item directive_item(const std::string& text) {
  Item item;
  item.directive = true;
  const std::string_view directive = directive_of(text);
  const std::vector<Token> tokens = tokens_of(operand_of(text));
  // What the compiler decides a branch by stays.
  if (directive == "if" || directive == "elif" || directive == "ifdef" || directive == "ifndef")
    note_uses(item, tokens, 0, tokens.size());
  if (directive != "define" && directive != "undef") return item;
  if (tokens.empty()) return item;
  item.name = tokens[0].text;
  if (directive == "undef") return item;
  std::size_t begin = 1;
  std::set<std::string_view> parameters;
  if (tokens.size() > 1 && tokens[1].text == "(" && tokens[1].at == tokens[0].text.size()) {
    for (; begin < tokens.size() && tokens[begin].text != ")"; ++begin)
      parameters.insert(tokens[begin].text);
    ++begin;
  }
  note_uses(item, tokens, begin, tokens.size());
  const auto is_parameter = [&](const std::string& name) { return parameters.contains(name); };
  std::erase_if(item.uses, is_parameter);
  std::erase_if(item.prefixes, is_parameter);
  if (parameters.empty() && tokens.size() == begin + 1 && item.uses.size() == 1)
    item.alias = item.uses.front();
  return item;
}

// The name of a function that may be dropped: `[attributes] static … name(`; "" for anything else.
std::string function_name(const std::vector<Token>& tokens, std::size_t begin, std::size_t end) {
  bool is_static = false;
  for (std::size_t i = begin; i < end; ++i) {
    if (tokens[i].text == "__attribute__") {
      int depth = 0;
      do {
        ++i;
        if (i < end) depth += tokens[i].text == "(" ? 1 : tokens[i].text == ")" ? -1 : 0;
      } while (i < end && depth > 0);
      continue;
    }
    if (tokens[i].text == "(")
      return is_static && i > begin ? std::string(tokens[i - 1].text) : std::string();
    if (tokens[i].text == "static") is_static = true;
    if (tokens[i].kind != Token::Kind::identifier && tokens[i].text != "*") return "";
  }
  return "";
}

class Piece {
 public:
  // Lines begin … end-1 are those of one piece.
  Piece(const Lines& lines, std::size_t begin, std::size_t end, std::vector<Item>& items)
      : lines_(lines), begin_(begin), end_(end), items_(items) {}

  void read() {
    read_directives();
    tokens_ = tokens_of(code_);
    read_code();
  }

 private:
  // Directives become items; `code_` is the rest, each line at its place.
  void read_directives() {
    for (std::size_t i = begin_; i < end_; ++i) {
      starts_.push_back(code_.size());
      if (directive_of(lines_[i].text).empty()) {
        code_ += fmt::format("{}\n", lines_[i].text);
        continue;
      }
      const std::size_t first = i;
      std::string text(lines_[i].text);
      while (text.ends_with('\\') && i + 1 < end_) {
        text.back() = ' ';
        text += lines_[++i].text;
        starts_.push_back(code_.size());
      }
      is_conditional_ = is_conditional_ || directive_of(text) == "if" ||
                        directive_of(text) == "ifdef" || directive_of(text) == "ifndef";
      Item item = directive_item(text);
      item.first = first;
      item.last = i;
      items_.push_back(std::move(item));
    }
  }

  std::size_t line_of(const Token& token) const {
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), token.at);
    return begin_ + static_cast<std::size_t>(after - starts_.begin()) - 1;
  }

  void read_code() {
    int round = 0, curly = 0;
    bool is_function = false;
    std::size_t first = 0;
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      const std::string_view text = tokens_[i].text;
      if (text == "{" && round == 0 && curly == 0)
        is_function = i > first && tokens_[i - 1].text == ")";
      round += text == "(" ? 1 : text == ")" ? -1 : 0;
      curly += text == "{" ? 1 : text == "}" ? -1 : 0;
      const bool ends = round == 0 && curly == 0 && (text == ";" || (text == "}" && is_function));
      if (!ends && i + 1 < tokens_.size()) continue;
      add_code(first, i + 1);
      first = i + 1;
      is_function = false;
    }
  }

  // A piece with branches that the compiler decides stays as it is: its brackets may not match.
  void add_code(std::size_t begin, std::size_t end) {
    Item item;
    item.first = line_of(tokens_[begin]);
    item.last = line_of(tokens_[end - 1]);
    if (!is_conditional_) item.name = function_name(tokens_, begin, end);
    note_uses(item, tokens_, begin, end);
    const bool shares = !items_.empty() && !items_.back().directive && last_code_ == item.first;
    if (shares) items_.back().name.clear();  // two declarations on a line: both stay
    if (shares) item.name.clear();
    last_code_ = item.last;
    items_.push_back(std::move(item));
  }

  const Lines& lines_;
  std::size_t begin_, end_;
  std::vector<Item>& items_;
  std::string code_;
  std::vector<std::size_t> starts_;  // of the lines in code_
  std::vector<Token> tokens_;
  bool is_conditional_ = false;
  std::size_t last_code_ = static_cast<std::size_t>(-1);
};

// Marks what the items that stay name, directly or through others.
class Reach {
 public:
  explicit Reach(std::vector<Item>& items) : items_(items) {
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (items[i].name.empty()) continue;
      named_.emplace(items[i].name, i);
      if (!items[i].alias.empty()) named_.emplace(items[i].alias, i);
    }
  }

  void mark() {
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i].name.empty()) visit(i);
    while (!open_.empty()) {
      const Item item = items_[open_.back()];
      open_.pop_back();
      // Slots are renamed by macros: whoever meets one name meets the other's code.
      if (!item.alias.empty()) visit_all(named_.equal_range(item.name));
      for (const std::string& name : item.uses) visit_all(named_.equal_range(name));
      for (const std::string& prefix : item.prefixes)
        for (auto it = named_.lower_bound(prefix);
             it != named_.end() && it->first.starts_with(prefix); ++it)
          visit(it->second);
    }
  }

 private:
  using Named = std::multimap<std::string, std::size_t>;
  void visit(std::size_t i) {
    if (items_[i].reached) return;
    items_[i].reached = true;
    open_.push_back(i);
  }
  void visit_all(std::pair<Named::const_iterator, Named::const_iterator> range) {
    for (auto it = range.first; it != range.second; ++it) visit(it->second);
  }

  std::vector<Item>& items_;
  Named named_;
  std::vector<std::size_t> open_;
};

bool is_blank(const SourceLine& line) {
  return line.text.find_first_not_of(" \t\r") == std::string_view::npos;
}

bool is_comment(const SourceLine& line) {
  const auto begin = line.text.find_first_not_of(" \t");
  return begin != std::string_view::npos && line.text.substr(begin, 2) == "//";
}

// Lines that go: those of unreached code, but of the directives among them the pragmas only, then
// those of directives; with either the comments directly above.
std::vector<bool> gone_lines(const Lines& lines, const std::vector<Item>& items) {
  std::vector<bool> gone(lines.size(), false);
  for (const bool directives : {false, true})
    for (const Item& item : items) {
      if (item.directive != directives) continue;
      for (std::size_t i = item.first; i <= item.last; ++i)
        if (directives || directive_of(lines[i].text).empty() ||
            directive_of(lines[i].text) == "pragma")
          gone[i] = gone[i] || !item.reached;
      for (std::size_t i = item.first; !item.reached && i > 0; --i) {
        if (!is_comment(lines[i - 1]) || lines[i - 1].path != lines[i].path) break;
        gone[i - 1] = true;
      }
    }
  return gone;
}

std::vector<Item> items_of(const Lines& lines) {
  std::vector<Item> items;
  for (std::size_t begin = 0; begin < lines.size();) {
    std::size_t end = begin;
    while (end < lines.size() && lines[end].path == lines[begin].path) ++end;
    if (!lines[begin].path.empty()) {
      Piece(lines, begin, end, items).read();
    } else {
      // The defines that say what the program is.
      for (std::size_t i = begin; i < end; ++i) {
        Item item;
        item.first = item.last = i;
        item.directive = true;
        items.push_back(std::move(item));
      }
    }
    begin = end;
  }
  return items;
}

// The lines that stay, each at its number; blank ones only between lines that were neighbours of
// theirs.
std::string text_of(const Lines& lines) {
  std::string text, path;
  std::size_t expected = 1;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const SourceLine& line = lines[i];
    const bool followed = i + 1 < lines.size() && lines[i + 1].path == line.path &&
                          lines[i + 1].number == line.number + 1 && !is_blank(lines[i + 1]);
    if (is_blank(line) && !followed) continue;
    if (line.path != path)
      text += fmt::format("#line {} \"{}\"\n", line.number, line.path);
    else if (line.number != expected)
      text += fmt::format("#line {}\n", line.number);
    text += fmt::format("{}\n", line.text);
    path = line.path;
    expected = line.number + 1;
  }
  return text;
}

// Pieces of which comments alone are left go altogether.
Lines kept_lines(const Lines& lines, std::vector<bool> gone, std::vector<DroppedCode>& dropped) {
  for (std::size_t begin = 0; begin < lines.size();) {
    std::size_t end = begin, bytes = 0;
    bool holds_code = lines[begin].path.empty();
    for (; end < lines.size() && lines[end].path == lines[begin].path; ++end) {
      bytes += lines[end].text.size() + 1;
      holds_code = holds_code || !(gone[end] || is_blank(lines[end]) || is_comment(lines[end]));
    }
    if (!holds_code) {
      std::fill(gone.begin() + static_cast<std::ptrdiff_t>(begin),
                gone.begin() + static_cast<std::ptrdiff_t>(end), true);
      const std::string& path = lines[begin].path;
      std::erase_if(dropped, [&](const DroppedCode& d) { return d.path == path; });
      dropped.push_back({"", path, bytes});
    }
    begin = end;
  }
  Lines kept;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!gone[i]) kept.push_back(lines[i]);
  return kept;
}

}  // namespace

PrunedText pruned(const std::string& text) {
  PrunedText result;
  const Lines all = source_lines(text), lines = open_lines(all);
  result.bytes_of_branches = bytes_of(all) - bytes_of(lines);
  std::vector<Item> items = items_of(lines);
  Reach(items).mark();
  for (const Item& item : items) {
    if (item.reached || item.directive) continue;
    std::size_t bytes = 0;
    for (std::size_t i = item.first; i <= item.last; ++i) bytes += lines[i].text.size() + 1;
    result.dropped.push_back({item.name, lines[item.first].path, bytes});
  }
  const Lines kept = kept_lines(lines, gone_lines(lines, items), result.dropped);
  result.text = text_of(kept);
  return result;
}

std::string without_closed_branches(const std::string& text) {
  return text_of(open_lines(source_lines(text)));
}

}  // namespace koksma
