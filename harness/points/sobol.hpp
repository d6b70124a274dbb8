// Generating matrices of Sobol' sequences.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace koksma {

// Columns of base-2 generating matrices as fractions of 64 bits: digit 1 (weight 1/2) is the top
// bit.
struct GeneratingMatrices {
  std::uint32_t dim = 0;
  std::uint32_t columns = 0;
  std::vector<std::uint64_t> words;  // [column][dimension]
};

inline constexpr std::uint32_t kMaxSobolColumns = 52;

// The first `columns` <= 52 columns of dimensions 1 … dim <= 3667, direction numbers of Joe and Kuo
// (2008, new-joe-kuo-6) as tabulated in Boost.
GeneratingMatrices sobol_matrices(std::uint32_t dim, std::uint32_t columns);

// The same from a file in Joe and Kuo's format: a heading, then per line d, s, a, m_1 … m_s, from d
// = 2 on (dimension 1 is van der Corput's). InputError names file and line; also when the file has
// fewer than dim dimensions.
GeneratingMatrices sobol_matrices_from_file(const std::string& path, std::uint32_t dim,
                                            std::uint32_t columns);

}  // namespace koksma
