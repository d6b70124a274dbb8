// Two-dimensional sets that the host builds.
#include <algorithm>
#include <bit>
#include <cmath>

#include "points/table.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kDarts = 3, kJitter = 4;  // blocks of the stream of point sets
// Darts for one point before all is thrown anew. At distance 0.7 a point takes 50 on average; of
// 10^6 points (250 sets) none took more than 703 (measured 2026-11-24).
constexpr std::uint64_t kMostDarts = std::uint64_t{1} << 16;

std::uint64_t squared_on_circle(std::uint32_t a, std::uint32_t b) {
  const std::uint64_t d = std::min(a - b, b - a);
  return d * d;
}

// The points in cells of a grid that grows with the set, so that a dart meets few of them.
class Grid {
 public:
  explicit Grid(PlanarSet& set) : set_(set) { rebuild(); }

  // True when a point lies nearer than the square root of `squared`, which is below half the torus.
  bool conflicts(std::uint32_t x, std::uint32_t y, std::uint64_t squared) const {
    const std::uint64_t radius = static_cast<std::uint64_t>(
        std::ceil(std::sqrt(static_cast<double>(squared)) * 0x1p-32 * static_cast<double>(side_)));
    const std::uint64_t reach = std::min(2 * radius + 1, side_);
    const std::uint64_t x0 = cell(x) + side_ - std::min(radius, side_);
    const std::uint64_t y0 = cell(y) + side_ - std::min(radius, side_);
    for (std::uint64_t row = 0; row < reach; ++row)
      for (std::uint64_t column = 0; column < reach; ++column)
        for (const std::size_t i : cells_[(y0 + row) % side_ * side_ + (x0 + column) % side_])
          if (squared_on_circle(x, high(2 * i)) + squared_on_circle(y, high(2 * i + 1)) < squared)
            return true;
    return false;
  }

  void add(std::uint32_t x, std::uint32_t y) {
    set_.push_back(std::uint64_t{x} << 32);
    set_.push_back(std::uint64_t{y} << 32);
    if (set_.size() / 2 > 2 * side_ * side_) return rebuild();
    hang(set_.size() / 2 - 1);
  }

 private:
  std::uint32_t high(std::size_t i) const { return static_cast<std::uint32_t>(set_[i] >> 32); }
  std::uint64_t cell(std::uint32_t x) const { return x * side_ >> 32; }
  void hang(std::size_t i) {
    cells_[cell(high(2 * i + 1)) * side_ + cell(high(2 * i))].push_back(
        static_cast<std::uint32_t>(i));
  }
  void rebuild() {
    side_ = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(std::sqrt(static_cast<double>(set_.size()))));
    cells_.assign(side_ * side_, {});
    for (std::size_t i = 0; i < set_.size() / 2; ++i) hang(i);
  }

  PlanarSet& set_;
  std::uint64_t side_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

// False when a point found no room.
bool fill(PlanarSet& set, std::uint64_t seed, std::uint32_t attempt, std::uint64_t size,
          double distance) {
  Grid grid(set);
  for (std::uint64_t n = 0; n < size; ++n) {
    // Squared, in units of 2^-64, rounded up.
    const auto squared = static_cast<std::uint64_t>(
                             std::ldexp(distance * distance / static_cast<double>(n + 1), 64)) +
                         1;
    bool found = false;
    for (std::uint64_t dart = 0; dart < kMostDarts && !found; ++dart) {
      const RandomPair random =
          random_pair(seed, n << 16 | dart, attempt, RandomPurpose::point_set, kDarts);
      const auto x = static_cast<std::uint32_t>(random.first >> 32);
      const auto y = static_cast<std::uint32_t>(random.second >> 32);
      found = n == 0 || !grid.conflicts(x, y, squared);
      if (found) grid.add(x, y);
    }
    if (!found) return false;
  }
  return true;
}

std::uint64_t digit(std::uint32_t k) { return std::uint64_t{1} << (63 - k); }  // weighs 2^-(k+1)
std::uint64_t first_digits(std::uint64_t x, std::uint32_t k) { return k == 0 ? 0 : x >> (64 - k); }

// Which of 2^k points lies in which elementary interval of area 2^-k: [a][x in 2^-a, y in
// 2^-(k-a)].
class Intervals {
 public:
  Intervals(const PlanarSet& set, std::uint32_t k) : k_(k), points_(k + 1) {
    const std::uint64_t n = set.size() / 2;
    for (std::uint32_t a = 0; a <= k; ++a) {
      points_[a].resize(n);
      for (std::uint64_t i = 0; i < n; ++i)
        points_[a][place(a, set[2 * i], set[2 * i + 1])] = static_cast<std::uint32_t>(i);
    }
  }
  std::uint64_t point(std::uint32_t a, std::uint64_t x, std::uint64_t y) const {
    return points_[a][place(a, x, y)];
  }

 private:
  std::uint64_t place(std::uint32_t a, std::uint64_t x, std::uint64_t y) const {
    return first_digits(x, a) << (k_ - a) | first_digits(y, k_ - a);
  }
  std::uint32_t k_;
  std::vector<std::vector<std::uint32_t>> points_;
};

// Twice the points. Every elementary interval of area 2^-k holds one old point and must get one new
// one, in neither the old one's x half nor its y half: the new point is opposite to the old one in
// each of the k + 1 intervals that hold it, one of every shape. Starting from the interval that it
// shares with its parent, the roundest, each next shape gives one more digit of x or of y, up to
// digit k + 1 of both. So these digits are determined and there is nothing to try; randomness is in
// the digits below, which the next doublings meet.
void double_points(PlanarSet& set, std::uint64_t seed, std::uint32_t k) {
  const Intervals intervals(set, k);
  const std::uint64_t n = set.size() / 2;
  const std::uint32_t middle = k / 2;
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto top = [](std::uint64_t word, std::uint32_t digits) {
      return word & ~(~std::uint64_t{0} >> digits);
    };
    std::uint64_t x = top(set[2 * i] ^ digit(middle), middle + 1);
    std::uint64_t y = top(set[2 * i + 1] ^ digit(k - middle), k - middle + 1);
    for (std::uint32_t a = middle + 1; a <= k; ++a)
      x |= ~set[2 * intervals.point(a, x, y)] & digit(a);
    for (std::uint32_t a = middle; a-- > 0;)
      y |= ~set[2 * intervals.point(a, x, y) + 1] & digit(k - a);
    const RandomPair random = random_pair(seed, n + i, 0, RandomPurpose::point_set, kJitter);
    set.push_back(x | (random.first & (digit(k) - 1)));
    set.push_back(y | (random.second & (digit(k) - 1)));
  }
}

}  // namespace

PlanarSet throw_darts(std::uint64_t seed, std::uint64_t size, double distance) {
  PlanarSet set;
  for (std::uint32_t attempt = 0; !fill(set, seed, attempt, size, distance); ++attempt) set.clear();
  return set;
}

PlanarSet progressive_multijitter(std::uint64_t seed, std::uint64_t size) {
  const RandomPair first = random_pair(seed, 0, 0, RandomPurpose::point_set, kJitter);
  PlanarSet set{first.first, first.second};
  for (std::uint32_t k = 0; set.size() / 2 < size; ++k) double_points(set, seed, k);
  return set;
}

}  // namespace koksma
