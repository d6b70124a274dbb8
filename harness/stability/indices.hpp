// Is every sample index used exactly once? Checksums of the indices that the integration kernel
// hands to its points, for any launch split and at offsets around 2^31, 2^32 and 2^63 (page 5,
// section 2.7).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "device/device.hpp"

namespace koksma {

// Of indices first ... end-1, modulo 2^64.
struct IndexSums {
  std::uint64_t count = 0, total = 0, squares = 0;
  std::uint64_t mixed = 0;  // XOR of a 64-bit mix of each

  bool operator==(const IndexSums&) const = default;
};

// By the closed forms n(n-1)/2 and (n-1)n(2n-1)/6, and a loop for the XOR.
IndexSums host_index_sums(std::uint64_t first, std::uint64_t end);

struct IndexRangeCheck {
  std::uint64_t first = 0, end = 0;
  std::uint32_t lanes_per_item = 16, log2_block = 8;
  std::optional<std::uint64_t> items_per_launch;
  bool count_ok = false, sum_ok = false, squares_ok = false, xor_ok = false;

  bool ok() const { return count_ok && sum_ok && squares_ok && xor_ok; }
};

struct IndexChecks {
  std::vector<IndexRangeCheck> checks;
  // Of all of them.
  bool sums_ok() const;  // with their counts
  bool squares_ok() const;
  bool xors_ok() const;
  bool ok = false;
  std::string
      why;  // also why nothing could be checked: the device lacks fp64, whose words hold an index
  double seconds = 0;
};

// The kernel is kernels/integrate.cl itself, with points, sum and integrand that pass indices on.
IndexChecks check_indices(const Catalog& with_indices, Device& device);

}  // namespace koksma
