// The picture of `koksma quality`: the points, and what is known of how they lie.
#pragma once

#include <string>

#include "quality/canvas.hpp"
#include "quality/quality.hpp"

namespace koksma {

// d <= 2: points | power spectrum | radial mean and pair correlation. Above: the first two
// coordinates | all planar projections of the first eight, as a lower triangle.
Canvas draw_quality(const PointSet& points, const Quality& quality, const std::string& title);

}  // namespace koksma
