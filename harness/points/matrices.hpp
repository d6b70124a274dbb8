// Generating matrices of base-2 nets and sequences.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "points/tables.hpp"

namespace koksma {

// Columns of base-2 generating matrices as fractions of 64 bits: digit 1 (weight 1/2) is the top
// bit.
struct GeneratingMatrices {
  std::uint32_t dim = 0;
  std::uint32_t columns = 0;
  std::vector<std::uint64_t> words;  // [column][dimension]
};

inline constexpr std::uint32_t kMaxMatrixColumns = 52;

// The first `columns` <= 52 columns of dimensions 1 … dim <= 3667, direction numbers of Joe and Kuo
// (2008, new-joe-kuo-6) as tabulated in Boost.
GeneratingMatrices sobol_matrices(std::uint32_t dim, std::uint32_t columns);

// The same for Niederreiter sequences in base 2, dim <= 4720, as Boost tabulates them (Bratley, Fox
// and Niederreiter 1992).
GeneratingMatrices niederreiter_matrices(std::uint32_t dim, std::uint32_t columns);

// i/N in dimension 1, N = 2^m the number of points, and a Sobol' sequence in the others.
GeneratingMatrices hammersley_matrices(std::uint32_t dim, std::uint32_t columns, std::uint64_t n);

// A file of the user's in LDData's "dnet" format (text, # begins a comment): base, which is 2,
// dimensions, number of points 2^m, bits r <= 64 of an integer; then per dimension the m columns as
// integers, digit 1 (weight 1/2) the r-th bit. InputError names file and line, also when the file
// has fewer dimensions or points than are drawn.
GeneratingMatrices matrices_from_file(const std::string& path, std::uint32_t dim,
                                      std::uint64_t end_index, std::uint32_t columns);

// What the request's option "net" asks for: sobol (with the user's direction numbers where
// there are some), niederreiter, hammersley, or the file of option "path".
GeneratingMatrices generating_matrices(const PointRequest& request, std::uint32_t columns);

// The same from a file in Joe and Kuo's format: a heading, then per line d, s, a, m_1 … m_s, from d
// = 2 on (dimension 1 is van der Corput's). InputError names file and line; also when the file has
// fewer than dim dimensions.
GeneratingMatrices sobol_matrices_from_file(const std::string& path, std::uint32_t dim,
                                            std::uint32_t columns);

}  // namespace koksma
