#include "points/matrices.hpp"

#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <sstream>

#include "error/error.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kWordBits = 64;

// The numbers of a text file, line by line, without comments.
class NumberLines {
 public:
  explicit NumberLines(const std::string& path) : path_(path), file_(path) {
    if (!file_)
      throw InputError(path, "the file of generating matrices cannot be read",
                       "give the path of a readable file");
  }

  // The next line that holds numbers; `what` is expected there.
  std::vector<std::uint64_t> next(const std::string& what) {
    std::string text;
    while (std::getline(file_, text)) {
      ++number_;
      std::istringstream words(text.substr(0, text.find('#')));
      std::vector<std::uint64_t> numbers;
      std::string word;
      while (words >> word) {
        std::size_t used = 0;
        try {
          numbers.push_back(std::stoull(word, &used));
        } catch (const std::exception&) {
          used = 0;
        }
        if (used != word.size() || word.front() == '-')
          throw InputError(where(), fmt::format("'{}'", word), "whole numbers, no less than 0");
      }
      if (!numbers.empty()) return numbers;
    }
    throw InputError(path_, "the file ends too early", fmt::format("{} was to come", what));
  }

  std::uint64_t one(const std::string& what, std::uint64_t least, std::uint64_t most) {
    const auto numbers = next(what);
    if (numbers.size() != 1 || numbers[0] < least || numbers[0] > most)
      throw InputError(where(),
                       numbers.size() == 1 ? fmt::format("{}", numbers[0])
                                           : fmt::format("{} numbers", numbers.size()),
                       fmt::format("{} comes here, {} to {}", what, least, most));
    return numbers[0];
  }

  std::string where() const { return fmt::format("{}:{}", path_, number_); }

 private:
  std::string path_;
  std::ifstream file_;
  std::size_t number_ = 0;
};

}  // namespace

GeneratingMatrices hammersley_matrices(std::uint32_t dim, std::uint32_t columns, std::uint64_t n) {
  GeneratingMatrices result{dim, columns, std::vector<std::uint64_t>(std::size_t{dim} * columns)};
  const auto m = static_cast<std::uint32_t>(std::bit_width(n - 1));
  for (std::uint32_t k = 0; k < m; ++k)
    result.words[std::size_t{k} * dim] = std::uint64_t{1} << (kWordBits - m + k);
  if (dim == 1) return result;
  const GeneratingMatrices sequence = sobol_matrices(dim - 1, columns);
  for (std::uint32_t k = 0; k < columns; ++k)
    for (std::uint32_t d = 1; d < dim; ++d)
      result.words[std::size_t{k} * dim + d] = sequence.words[std::size_t{k} * (dim - 1) + d - 1];
  return result;
}

GeneratingMatrices matrices_from_file(const std::string& path, std::uint32_t dim,
                                      std::uint64_t end_index, std::uint32_t columns) {
  NumberLines lines(path);
  lines.one("the base, 2,", 2, 2);
  const std::uint64_t dimensions = lines.one("the number of dimensions", 1, UINT32_MAX);
  const std::uint64_t points = lines.one("the number of points", 1, std::uint64_t{1} << 63);
  if (!std::has_single_bit(points))
    throw InputError(lines.where(), fmt::format("{} points", points), "a power of two comes here");
  const std::uint64_t bits = lines.one("the number of bits of an integer", 1, kWordBits);
  const auto m = static_cast<std::uint32_t>(std::bit_width(points) - 1);
  if (dimensions < dim)
    throw InputError(path, fmt::format("matrices for {} dimensions", dimensions),
                     fmt::format("{} are drawn", dim));
  if (end_index > points)
    throw InputError(path, fmt::format("matrices for {} points", points),
                     fmt::format("{} are drawn", end_index));
  GeneratingMatrices result{dim, columns, std::vector<std::uint64_t>(std::size_t{dim} * columns)};
  for (std::uint32_t d = 0; d < dim; ++d) {
    const auto numbers = lines.next(fmt::format("the matrix of dimension {}", d + 1));
    if (numbers.size() != m)
      throw InputError(lines.where(), fmt::format("{} columns", numbers.size()),
                       fmt::format("2^{} points have {}", m, m));
    for (std::uint32_t k = 0; k < m; ++k) {
      if (bits < kWordBits && numbers[k] >> bits != 0)
        throw InputError(lines.where(), fmt::format("column {} is {}", k + 1, numbers[k]),
                         fmt::format("an integer has {} bits", bits));
      if (k < columns) result.words[std::size_t{k} * dim + d] = numbers[k] << (kWordBits - bits);
    }
  }
  return result;
}

namespace {

GeneratingMatrices matrices_by_dimension(const PointRequest& request, std::uint32_t columns) {
  const std::string kind = request.options.at("net");
  if (kind == "niederreiter-base-2") return niederreiter_matrices(request.dim, columns);
  if (kind == "hammersley-base-2")
    return hammersley_matrices(request.dim, columns, request.end_index);
  if (kind == "file")
    return matrices_from_file(request.options.at("path"), request.dim, request.end_index, columns);
  return request.directions_file.empty()
             ? sobol_matrices(request.dim, columns)
             : sobol_matrices_from_file(request.directions_file, request.dim, columns);
}

}  // namespace

// The components of an interlaced coordinate are neighbours and stay together.
GeneratingMatrices generating_matrices(const PointRequest& request, std::uint32_t columns) {
  GeneratingMatrices result = matrices_by_dimension(request, columns);
  if (request.dimension_order.empty()) return result;
  const std::vector<std::uint64_t> plain = result.words;
  const std::size_t dim = result.dim, components = dim / request.dimension_order.size();
  for (std::size_t k = 0; k < result.columns; ++k)
    for (std::size_t d = 0; d < dim; ++d)
      result.words[k * dim + d] =
          plain[k * dim + request.dimension_order[d / components] * components + d % components];
  return result;
}

}  // namespace koksma
