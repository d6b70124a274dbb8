// The Pareto front is what a comparison of every pair of points leaves.
#include "estimate/pareto.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace koksma;

namespace {

// By the definition alone.
std::vector<std::size_t> brute_force(const std::vector<ErrorTime>& points) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const ErrorTime& q) {
      const ErrorTime& p = points[i];
      return q.seconds <= p.seconds && q.error <= p.error &&
             (q.seconds < p.seconds || q.error < p.error);
    });
    if (!beaten) front.push_back(i);
  }
  return front;
}

}  // namespace

TEST_CASE("the front is that of brute force, with ties and duplicates", "[unit]") {
  std::mt19937_64 engine(7);
  std::size_t ties = 0;
  for (int round = 0; round < 2000; ++round) {
    // Small integers, so that times, errors and whole points are often equal.
    std::vector<ErrorTime> points(engine() % 40);
    for (ErrorTime& p : points)
      p = {1 + static_cast<double>(engine() % 12), static_cast<double>(engine() % 12)};
    std::vector<std::size_t> front = pareto_front(points);
    CHECK(std::is_sorted(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
      return points[a].seconds < points[b].seconds;
    }));
    for (std::size_t k = 1; k < front.size(); ++k)
      if (points[front[k]].seconds == points[front[k - 1]].seconds) ++ties;
    std::sort(front.begin(), front.end());
    REQUIRE(front == brute_force(points));
  }
  CHECK(ties > 100);
}

TEST_CASE("points without a time or an error are on no front and beat nothing", "[unit]") {
  const double nan = std::nan("");
  const std::vector<ErrorTime> points{{0, 0},  {-1, 0}, {nan, 0},      {1, nan},
                                      {1, -1}, {2, 3},  {INFINITY, 0}, {3, INFINITY}};
  CHECK(pareto_front(points) == std::vector<std::size_t>{5});
  CHECK(pareto_front(std::vector<ErrorTime>{}).empty());
}

TEST_CASE("an error of 0 ends the front", "[unit]") {
  CHECK(pareto_front(std::vector<ErrorTime>{{1, 2}, {2, 0}, {3, 0}}) ==
        std::vector<std::size_t>{0, 1});
}
