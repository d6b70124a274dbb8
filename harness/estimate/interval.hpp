// A closed interval with finite ends, of 95 % confidence wherever the harness reports one.
#pragma once

namespace koksma {

struct Interval {
  double low = 0;
  double high = 0;
};

// Probability left out on each side.
inline constexpr double kIntervalTail = 0.025;

}  // namespace koksma
