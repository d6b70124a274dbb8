// Operations per coordinate of a plan's kernel, counted while it runs (plan/instrument.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "plan/plan.hpp"

namespace koksma {

// Per coordinate; a sample's operations are shared by its coordinates.
struct OperationRow {
  std::string name;
  double points = 0, integrand = 0, sum = 0;
};

struct OperationCount {
  std::uint64_t samples = 0;  // that ran
  std::uint32_t lanes = 0, coordinates = 0;
  std::vector<OperationRow> vectors;  // operations of all lanes at once, the most frequent first
  // What lanes share, of little weight beside them: scalar operations (subscripts, loops) and
  // elements of arrays read or written one by one.
  OperationRow scalar, element;

  // Operations of vectors per coordinate.
  double points() const;
  double integrand() const;
  // Coordinates dominate where making them takes more operations than using them.
  bool points_dominate() const { return points() > integrand(); }
};

// Runs 64 samples for every lane of a work-item, or N / 16 where that is less; of data-dependent
// loops the count is an average over them. UnsupportedError where a piece can not be read, or keeps
// so many coordinates that no vector of lanes fits.
OperationCount count_operations(Device& device, const Catalog& catalog, const Plan& plan,
                                const std::vector<double>& coefficients);

// Lines of a table, each indented by two spaces.
std::string operations_table(const OperationCount& count);
Json operations_json(const OperationCount& count);

}  // namespace koksma
