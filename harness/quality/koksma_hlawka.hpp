// The Koksma-Hlawka inequality for one scene and one point set: |Q - I| <= V_HK(f) D*.
#pragma once

#include <optional>
#include <string>

#include "estimate/measure.hpp"
#include "quality/quality.hpp"

namespace koksma {

struct KoksmaHlawka {
  Scene scene;
  std::optional<double> variation;  // of Hardy and Krause, anchored at 1
  std::string variation_source;     // its formula, or why there is none
  std::optional<double> bound;      // variation times star_upper
  std::string bound_reason;         // why there is none
  std::optional<double> error;      // |Q - I| of the first set
  std::string error_reason;         // why there is none
};

// cell: one scene, one size, the points of `quality`, 1 replicate. The error is that of the
// integration kernel.
KoksmaHlawka koksma_hlawka(const Catalog& catalog, Device& device, const Cell& cell,
                           const Quality& quality, const std::string& directions_file);

}  // namespace koksma
