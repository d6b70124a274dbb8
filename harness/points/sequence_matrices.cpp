#include <fmt/format.h>

#include <bit>
#include <boost/random/niederreiter_base2.hpp>
#include <boost/random/sobol.hpp>
#include <fstream>
#include <sstream>

#include "error/error.hpp"
#include "points/matrices.hpp"

namespace koksma {
namespace {

constexpr unsigned kMatrixBits = 64;

struct DirectionLine {
  std::uint32_t dimension = 0, degree = 0;
  std::uint64_t coefficients = 0;
  std::vector<std::uint64_t> m;
};

DirectionLine parse_line(const std::string& text, const std::string& where) {
  std::istringstream line(text);
  DirectionLine result;
  if (!(line >> result.dimension >> result.degree >> result.coefficients) || result.degree == 0 ||
      result.degree > 51)
    throw InputError(where, fmt::format("'{}'", text), "a line holds d, s, a and m_1 … m_s");
  for (std::uint32_t k = 1; k <= result.degree; ++k) {
    std::uint64_t m = 0;
    if (!(line >> m) || m % 2 == 0 || m >> k != 0)
      throw InputError(where,
                       fmt::format("m_{} of dimension {} is missing or wrong", k, result.dimension),
                       "m_k is odd and below 2^k");
    result.m.push_back(m);
  }
  return result;
}

// v_k = a_1 v_{k-1} ^ … ^ a_{s-1} v_{k-s+1} ^ v_{k-s} ^ v_{k-s} >> s (Joe & Kuo 2008, eq. 2), as
// fractions.
void extend_columns(const DirectionLine& line, GeneratingMatrices& matrices, std::uint32_t d) {
  const auto at = [&](std::uint32_t k) -> std::uint64_t& {
    return matrices.words[std::size_t{k} * matrices.dim + d];
  };
  const std::uint32_t s = line.degree;
  for (std::uint32_t k = 0; k < matrices.columns; ++k) {
    if (k < s) {
      at(k) = line.m[k] << (kMatrixBits - 1 - k);
      continue;
    }
    std::uint64_t v = at(k - s) ^ at(k - s) >> s;
    for (std::uint32_t i = 1; i < s; ++i)
      if ((line.coefficients >> (s - 1 - i) & 1) != 0) v ^= at(k - i);
    at(k) = v;
  }
}

// The matrices of one of Boost's Gray-coded engines. Point 2^k - 1 (they skip the zero point) is
// C gray(2^k) = column k ^ column k-1.
template <typename Engine>
GeneratingMatrices matrices_of(Engine engine, std::uint32_t dim, std::uint32_t columns) {
  GeneratingMatrices result{dim, columns, std::vector<std::uint64_t>(std::size_t{dim} * columns)};
  for (std::uint32_t k = 0; k < columns; ++k) {
    engine.seed((std::uint64_t{1} << k) - 1);
    for (std::uint32_t d = 0; d < dim; ++d) {
      std::uint64_t& word = result.words[std::size_t{k} * dim + d];
      word = engine();
      if (k > 0) word ^= result.words[std::size_t{k - 1} * dim + d];
    }
  }
  return result;
}

GeneratingMatrices empty_matrices(std::uint32_t dim, std::uint32_t columns) {
  return {dim, columns, std::vector<std::uint64_t>(std::size_t{dim} * columns)};
}

}  // namespace

GeneratingMatrices sobol_matrices(std::uint32_t dim, std::uint32_t columns) {
  return matrices_of(boost::random::sobol_engine<std::uint64_t, kMatrixBits>(dim), dim, columns);
}

GeneratingMatrices niederreiter_matrices(std::uint32_t dim, std::uint32_t columns) {
  return matrices_of(boost::random::niederreiter_base2_engine<std::uint64_t, kMatrixBits>(dim), dim,
                     columns);
}

GeneratingMatrices sobol_matrices_from_file(const std::string& path, std::uint32_t dim,
                                            std::uint32_t columns) {
  std::ifstream file(path);
  if (!file)
    throw InputError(path, "the direction-number file cannot be read",
                     "give the path of a readable file");
  GeneratingMatrices result = empty_matrices(dim, columns);
  for (std::uint32_t k = 0; k < columns; ++k)
    result.words[std::size_t{k} * dim] = std::uint64_t{1} << (kMatrixBits - 1 - k);
  std::string text;
  std::getline(file, text);  // the heading
  std::uint32_t found = 1;
  for (std::size_t number = 2; found < dim && std::getline(file, text); ++number) {
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string where = fmt::format("{}:{}", path, number);
    const DirectionLine line = parse_line(text, where);
    if (line.dimension != found + 1)
      throw InputError(where, fmt::format("dimension {}", line.dimension),
                       fmt::format("dimension {} comes here", found + 1));
    extend_columns(line, result, found++);
  }
  if (found < dim)
    throw InputError(path, fmt::format("direction numbers for {} dimensions", found),
                     fmt::format("{} are drawn", dim));
  return result;
}

}  // namespace koksma
