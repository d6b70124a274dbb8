// Points from a user's file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace koksma {

struct PointFile {
  std::uint64_t rows = 0;
  std::uint32_t columns = 0;
  std::vector<double> values;  // [row][column], all in [0,1)
};

// F.npy (NumPy's format 1.0 or 2.0, https://numpy.org/doc/stable/reference/generated/
// numpy.lib.format.html: little-endian f4 or f8, C order, one or two axes; one axis is one column)
// or F.csv (a point per line, numbers apart by commas, semicolons, blanks or tabs; the first line
// may be a heading). InputError naming the file, the place, what was found and what is allowed.
PointFile read_point_file(const std::string& path);

}  // namespace koksma
