// What changes the bits of a sum: vector width, work-group size, launch split, block length (page
// 5, section 2.3), through the integration kernel and the integrator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "catalog/catalog.hpp"
#include "device/device.hpp"

namespace koksma {

struct InvarianceRow {
  std::string sum;
  bool order_free = false;
  std::size_t distinct = 0;  // results over all shapes
  std::size_t most_of_one_block =
      0;              // results over the shapes of one block length, the most of any
  double spread = 0;  // (largest - smallest) / largest absolute value
  bool finite = true;
};

struct Invariance {
  Precision precision = Precision::fp32;
  std::uint64_t n = 0;
  std::size_t shapes = 0;
  std::vector<InvarianceRow> rows;
  bool ok = false;
  std::string why;
  double seconds = 0;
};

struct InvarianceOptions {
  std::uint64_t n = std::uint64_t{1} << 21;
  std::vector<std::uint32_t> log2_blocks{10, 16, 21};
  std::vector<std::string> sums;  // empty: all that the device has
};

// n uniform random terms in fp32 by every width (1, 4, 8, 16 lanes per item), a work-group size for
// each, launches of all blocks, of 64 and of 5, and every block length: 36 shapes by default.
// Holds: shapes of one block length give one result; order-free sums give one over all.
Invariance measure_invariance(const Catalog& with_terms, Device& device,
                              const InvarianceOptions& options = {});

}  // namespace koksma
