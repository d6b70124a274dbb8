#include "points/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <regex>
#include <sstream>

#include "catalog/json.hpp"
#include "error/error.hpp"

namespace koksma {
namespace {

constexpr const char* kRange = "coordinates lie in [0,1)";

void check_coordinate(double x, const std::string& where) {
  if (!(x >= 0 && x < 1)) throw InputError(where, fmt::format("{}", x), kRange);
}

// Little-endian whatever the host.
std::uint64_t little_endian(const char* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

struct NpyHeader {
  std::size_t size = 0;        // where the data begin
  std::size_t value_size = 8;  // bytes
  std::uint64_t rows = 0, columns = 1;
};

[[noreturn]] void refuse_header(const std::string& path, const std::string& found,
                                const std::string& allowed) {
  throw InputError(fmt::format("{}, header", path), found, allowed);
}

NpyHeader read_npy_header(const std::string& path, const std::string& text) {
  if (text.size() < 12 || text.compare(0, 6, "\x93NUMPY") != 0)
    throw InputError(path, "no NumPy file", "a .npy file begins with \\x93NUMPY");
  const int version = static_cast<unsigned char>(text[6]);
  if (version != 1 && version != 2)
    refuse_header(path, fmt::format("version {}.{}", version, static_cast<unsigned char>(text[7])),
                  "versions 1.0 and 2.0 are read");
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  NpyHeader header;
  header.size = 8 + length_bytes + little_endian(text.data() + 8, length_bytes);
  if (header.size > text.size()) refuse_header(path, "the file ends in it", "a whole header");
  const std::string fields = text.substr(8 + length_bytes, header.size - 8 - length_bytes);

  std::smatch found;
  if (!std::regex_search(fields, found, std::regex(R"('descr'\s*:\s*('[^']*'|\[[^\]]*\]))")))
    refuse_header(path, "no 'descr'", "'<f8' or '<f4'");
  const std::string type = found[1];
  if (type != "'<f8'" && type != "'<f4'")
    refuse_header(path, fmt::format("values of type {}", type), "'<f8' or '<f4'");
  header.value_size = type == "'<f8'" ? 8 : 4;
  if (!std::regex_search(fields, std::regex(R"('fortran_order'\s*:\s*False)")))
    refuse_header(path, "Fortran order", "C order (numpy.ascontiguousarray)");
  static const std::regex shape(R"('shape'\s*:\s*\(\s*(\d{1,18})\s*,\s*(\d{1,9})?\s*,?\s*\))");
  if (!std::regex_search(fields, found, shape))
    refuse_header(path, fmt::format("the shape in {}", fields), "one or two axes");
  header.rows = std::stoull(found[1]);
  if (found[2].matched) header.columns = std::stoull(found[2]);
  return header;
}

PointFile read_npy(const std::string& path, const std::string& text) {
  const NpyHeader header = read_npy_header(path, text);
  const std::uint64_t bytes = text.size() - header.size;
  const std::uint64_t row_bytes = header.columns * header.value_size;
  if (row_bytes == 0 || header.rows == 0)
    throw InputError(path, fmt::format("{} rows of {} columns", header.rows, header.columns),
                     "at least one of each");
  if (bytes / row_bytes != header.rows || bytes % row_bytes != 0)
    throw InputError(path, fmt::format("{} bytes of data", bytes),
                     fmt::format("{} rows of {} bytes by its header", header.rows, row_bytes));
  PointFile file{header.rows, static_cast<std::uint32_t>(header.columns), {}};
  file.values.reserve(header.rows * header.columns);
  const char* data = text.data() + header.size;
  for (std::uint64_t i = 0; i < header.rows * header.columns; ++i) {
    const std::uint64_t bits = little_endian(data + i * header.value_size, header.value_size);
    const auto narrow = static_cast<std::uint32_t>(bits);
    double x = std::bit_cast<double>(bits);
    if (header.value_size == 4) x = std::bit_cast<float>(narrow);
    if (!(x >= 0 && x < 1))
      check_coordinate(x, fmt::format("{}, row {}, column {}", path, i / header.columns + 1,
                                      i % header.columns + 1));
    file.values.push_back(x);
  }
  return file;
}

// The numbers of a line; empty where the line holds something else, which `wrong` names.
std::vector<double> numbers_of(const std::string& line, std::string& wrong) {
  std::vector<double> numbers;
  const char *at = line.data(), *end = at + line.size();
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  const auto separates = [&](char c) { return c == ',' || c == ';'; };
  bool expected = false;  // a number, after a comma
  while (true) {
    while (at != end && blank(*at)) ++at;
    if (at == end && !expected) return numbers;
    double x = 0;
    // from_chars knows no plus sign.
    const char* digits = at != end && *at == '+' ? at + 1 : at;
    const auto [rest, error] = std::from_chars(digits, end, x);
    const bool ends = rest == end || blank(*rest) || separates(*rest);
    if (error != std::errc{} || !ends) {
      const char* until = std::find_if(at, end, [&](char c) { return blank(c) || separates(c); });
      wrong = std::string(at, until);
      return {};
    }
    numbers.push_back(x);
    at = rest;
    while (at != end && blank(*at)) ++at;
    expected = at != end && separates(*at);
    if (expected) ++at;
  }
}

// A first line without a single number. A line that begins like a point and goes on otherwise is a
// mistake, not a heading.
bool is_heading(const std::string& line) {
  std::string rest = line;
  std::replace_if(
      rest.begin(), rest.end(), [](char c) { return c == ',' || c == ';' || c == '\t'; }, ' ');
  std::istringstream words(rest);
  std::string ignored;
  for (std::string word; words >> word;)
    if (!numbers_of(word, ignored).empty() ||
        std::string("+-.0123456789").find(word.front()) != std::string::npos)
      return false;
  return true;
}

PointFile read_csv(const std::string& path, const std::string& contents) {
  PointFile file;
  // Spreadsheets put a byte order mark before the first number.
  const std::string text = contents.starts_with("\xEF\xBB\xBF") ? contents.substr(3) : contents;
  std::size_t number = 0;
  bool heading_may_come = true;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string where = fmt::format("{}:{}", path, number);
    std::string wrong;
    const std::vector<double> numbers = numbers_of(line, wrong);
    const bool heading = heading_may_come && is_heading(line);
    heading_may_come = false;
    if (heading) continue;
    if (numbers.empty())
      throw InputError(where, fmt::format("'{}'", wrong), "numbers, with commas or blanks between");
    if (file.rows == 0) file.columns = static_cast<std::uint32_t>(numbers.size());
    if (numbers.size() != file.columns)
      throw InputError(where, fmt::format("{} numbers", numbers.size()),
                       fmt::format("{}, as in the lines before", file.columns));
    for (std::size_t j = 0; j < numbers.size(); ++j)
      check_coordinate(numbers[j], fmt::format("{}, column {}", where, j + 1));
    file.values.insert(file.values.end(), numbers.begin(), numbers.end());
    ++file.rows;
  }
  if (file.rows == 0) throw InputError(path, "no points", "a point per line");
  return file;
}

}  // namespace

PointFile read_point_file(const std::string& path) {
  if (path.ends_with(".npy")) return read_npy(path, read_text_file(path));
  if (path.ends_with(".csv")) return read_csv(path, read_text_file(path));
  throw InputError(path, "its name ends in neither .npy nor .csv", "one of them");
}

}  // namespace koksma
