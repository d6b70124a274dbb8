// Many integrands in one program, evaluated at given points. A program costs PoCL about half a
// second whatever is in it, so tests that meet every integrand share programs.
#pragma once

#include <cstdint>
#include <vector>

#include "plan/plan.hpp"
#include "tests/support.hpp"

namespace koksma::test {

// One integrand at 16 points of its scene.
struct BatchItem {
  Scene scene;
  std::vector<double> x;  // [dimension][16], exact in the precision of the batch
};

struct BatchValue {
  std::vector<double> f;    // [16]
  std::uint32_t drawn = 0;  // coordinates per point
};

// f at the points of every item, whose scenes all have the same dimension, with `lanes` lanes per
// work-item. The points are handed to the integrands in the order in which they draw.
std::vector<BatchValue> evaluate(const std::vector<BatchItem>& items, Precision precision,
                                 std::uint32_t lanes);

}  // namespace koksma::test
