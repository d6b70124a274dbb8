#include "estimate/pareto.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace koksma {

std::vector<std::size_t> pareto_front(std::span<const ErrorTime> points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ErrorTime& p = points[i];
    if (std::isfinite(p.seconds) && p.seconds > 0 && std::isfinite(p.error) && p.error >= 0)
      order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].seconds != points[b].seconds ? points[a].seconds < points[b].seconds
                                                  : points[a].error < points[b].error;
  });

  // By ascending time the front is where the error is least so far; an equal error is one only in
  // the same time.
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    const bool equal = !front.empty() && points[front.back()].seconds == points[i].seconds &&
                       points[i].error == least;
    if (!(points[i].error < least) && !equal) continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

}  // namespace koksma
