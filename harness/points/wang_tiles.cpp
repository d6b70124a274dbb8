// The rule and the points of recursive Wang tiles: threshold accepting (G. Dueck & T. Scheuer, J.
// Comput. Phys. 90, 1990) over which of its 16 sub-cells holds each cell's point. All arithmetic is
// in integers, so a seed has the same tiles everywhere.
#include "points/wang_tiles.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "points/tables.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kBlock = 5;         // of the stream of point sets
constexpr unsigned kBits = 12;              // of a place in a cell, while searching
constexpr std::int64_t kCell = 1 << kBits;  // units of a cell's side, and angles of a circle
constexpr unsigned kDigits = 16;            // base-4 digits of a coordinate
// A point that moves takes along those that lead to it, each by a quarter as far: beyond so many
// steps it is less than a unit of kBits.
constexpr std::size_t kReach = 5;
// Measured on 2026-11-24 over 16 seeds at N = 4096, power below a quarter of the cells' frequency:
// 0.08 of white noise on average; 0.12 if all frequencies weigh the same. Twice the sweeps, or half
// the weight of all, change it by no more than other seeds do.
constexpr std::int64_t kSweeps = 100, kCalmSweeps = 100, kThreshold = 3000;
constexpr unsigned kSpectrumShift = 13;
// Frequencies per tile that are kept low, up to a little beyond that of the cells, and the lowest
// of them, which weigh more.
constexpr std::int64_t kMostFrequency = 4, kMostSquared = 20, kLowSquared = 2, kLowWeight = 16;

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint32_t attempt) : seed_(seed), attempt_(attempt) {}
  // Below 2^bits, bits <= 16.
  std::size_t next(unsigned bits) {
    if (drawn_ % 8 == 0)
      pair_ = random_pair(seed_, drawn_ / 8, attempt_, RandomPurpose::point_set, kBlock);
    const std::uint64_t word = drawn_ % 8 < 4 ? pair_.first : pair_.second;
    return (word >> 16 * (drawn_++ % 4) & 0xFFFF) >> (16 - bits);
  }

 private:
  std::uint64_t seed_;
  std::uint32_t attempt_;
  std::uint64_t drawn_ = 0;
  RandomPair pair_{};
};

// An edge is four edges of the next level: of either colour two, and of the other colour's the
// opposites. What is inside a tile is drawn per type.
WangTiles::Places<std::uint8_t> draw_rule(RandomStream& random) {
  constexpr std::array<unsigned, 8> kBalanced{3, 5, 6, 9, 10, 12, 5, 10};
  const auto outer = [&] {
    const unsigned pattern = kBalanced[random.next(3)];
    return std::array<unsigned, 2>{pattern, pattern ^ 15};
  };
  const auto vertical = outer(), horizontal = outer();
  WangTiles::Places<std::uint8_t> rule;
  for (std::size_t type = 0; type < kWangTypes; ++type) {
    // The colours of line k = 0 ... 4, a bit for every cell along it.
    std::array<std::size_t, 5> upright, level;
    for (auto* lines : {&upright, &level})
      for (std::size_t& line : *lines) line = random.next(4);
    upright[0] = vertical[type & 1];
    upright[4] = vertical[type >> 1 & 1];
    level[0] = horizontal[type >> 2 & 1];
    level[4] = horizontal[type >> 3 & 1];
    for (std::size_t cell = 0; cell < kWangCells; ++cell) {
      const std::size_t column = cell & 3, row = cell >> 2;
      rule[type << 4 | cell] = static_cast<std::uint8_t>(
          (upright[column] >> row & 1) | (upright[column + 1] >> row & 1) << 1 |
          (level[row] >> column & 1) << 2 | (level[row + 1] >> column & 1) << 3);
    }
  }
  return rule;
}

class Search {
 public:
  Search(std::uint64_t seed, std::uint32_t attempt, double distance)
      : random_(seed, attempt),
        neighbours_(wang_neighbours()),
        // A unit of either coordinate is lost where they are cut to kBits.
        least_(static_cast<std::int64_t>(std::ceil(std::pow(distance * kCell + 2, 2)))) {
    for (std::size_t a = 0; a < waves_.size(); ++a) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(a) / kCell;
      waves_[a] = {std::lround(256 * std::cos(angle)), std::lround(256 * std::sin(angle))};
    }
    for (std::int64_t f = 0; f <= kMostFrequency; ++f)
      for (std::int64_t g = f > 0 ? -kMostFrequency : 1; g <= kMostFrequency; ++g)
        if (f * f + g * g <= kMostSquared)
          spectrum_.push_back({f, g, f * f + g * g <= kLowSquared ? kLowWeight : 1, {0, 0}});
    tiles_.type = draw_rule(random_);
    tiles_.x.fill(0);
    tiles_.y.fill(0);
    for (std::size_t place = 0; place < kWangPlaces; ++place) {
      tiles_.sub_cell[place] = static_cast<std::uint8_t>(random_.next(4));
      leading_[tiles_.next(place)].push_back(place);
    }
  }

  // True when all points keep the distance.
  bool run() {
    settle();
    for (std::int64_t left = kSweeps; left > 0; --left)
      sweep(kThreshold * left * left / (kSweeps * kSweeps), true);
    for (std::int64_t calm = 0; calm < kCalmSweeps && crowding() > 0; ++calm) sweep(0, false);
    return crowding() == 0;
  }

  const WangTiles& tiles() const { return tiles_; }

 private:
  struct Wave {
    std::int64_t real, imaginary;
  };
  struct Frequency {
    std::int64_t f, g, weight;
    Wave sum;  // over the points of all types
  };

  std::int64_t x(std::size_t place) const { return tiles_.x[place] >> (32 - kBits); }
  std::int64_t y(std::size_t place) const { return tiles_.y[place] >> (32 - kBits); }

  void place_point(std::size_t place) {
    const std::size_t next = tiles_.next(place);
    tiles_.x[place] = static_cast<std::uint32_t>(next & 3) << 30 | tiles_.x[next] >> 2;
    tiles_.y[place] = static_cast<std::uint32_t>(next >> 2 & 3) << 30 | tiles_.y[next] >> 2;
  }

  // All positions to their last digit, and the spectrum of them.
  void settle() {
    for (unsigned digit = 0; digit < kDigits; ++digit)
      for (std::size_t place = 0; place < kWangPlaces; ++place) place_point(place);
    for (Frequency& k : spectrum_) k.sum = {0, 0};
    for (std::size_t place = 0; place < kWangPlaces; ++place) count_waves(place, 1);
  }

  void count_waves(std::size_t place, std::int64_t sign) {
    const auto cell = [](std::size_t of) { return static_cast<std::int64_t>(of & 3) << kBits; };
    const std::int64_t across = (cell(place) + x(place)) >> 2,
                       up = (cell(place >> 2) + y(place)) >> 2;
    for (Frequency& k : spectrum_) {
      const Wave& wave = waves_[static_cast<std::size_t>((k.f * across + k.g * up) & (kCell - 1))];
      k.sum.real += sign * wave.real;
      k.sum.imaginary += sign * wave.imaginary;
    }
  }

  // Power of the mean tile: it repeats with every tile, so that it grows with their number.
  std::int64_t spectral_energy() const {
    std::int64_t sum = 0;
    for (const Frequency& k : spectrum_)
      sum += k.weight * (k.sum.real * k.sum.real + k.sum.imaginary * k.sum.imaginary);
    return sum >> kSpectrumShift;
  }

  // Of all pairs of a place: the square of what lacks in the squared distance.
  std::int64_t crowding(std::size_t place) const {
    std::int64_t sum = 0;
    for (const WangNeighbour& n : neighbours_[place]) {
      const std::int64_t dx = x(n.place) + n.columns * kCell - x(place);
      const std::int64_t dy = y(n.place) + n.rows * kCell - y(place);
      const std::int64_t lacking = least_ - dx * dx - dy * dy;
      // In units of 2^-16 squared cells; pairs of places that both move count at both.
      if (lacking > 0) sum += (1 + (lacking * lacking >> 22)) * (moving_[n.place] == move_ ? 1 : 2);
    }
    return sum;
  }

  std::int64_t crowding() {
    ++move_;
    std::int64_t sum = 0;
    for (std::size_t place = 0; place < kWangPlaces; ++place) sum += crowding(place);
    return sum;
  }

  // The places whose points move with that of this one, itself first.
  std::vector<std::size_t> moved_with(std::size_t place) {
    std::vector<std::size_t> moved{place};
    moving_[place] = ++move_;
    for (std::size_t step = 0, begin = 0; step < kReach; ++step) {
      const std::size_t end = moved.size();
      for (; begin < end; ++begin)
        for (const std::size_t p : leading_[moved[begin]])
          if (std::exchange(moving_[p], move_) != move_) moved.push_back(p);
    }
    return moved;
  }

  std::int64_t energy(const std::vector<std::size_t>& moved, bool spectral) const {
    std::int64_t sum = spectral ? spectral_energy() : 0;
    for (const std::size_t place : moved) sum += crowding(place);
    return sum;
  }

  void choose(const std::vector<std::size_t>& moved, std::uint8_t sub_cell) {
    const std::size_t place = moved.front();
    std::erase(leading_[tiles_.next(place)], place);
    tiles_.sub_cell[place] = sub_cell;
    leading_[tiles_.next(place)].push_back(place);
    for (const std::size_t p : moved) count_waves(p, -1);
    // Where a point leads to itself, the second time brings it nearer.
    for (unsigned time = 0; time < 2; ++time)
      for (const std::size_t p : moved) place_point(p);
    for (const std::size_t p : moved) count_waves(p, 1);
  }

  // As many moves as places; one is kept where the energy grows by no more than the threshold.
  void sweep(std::int64_t threshold, bool spectral) {
    for (std::size_t i = 0; i < kWangPlaces; ++i) {
      const std::size_t place = random_.next(8);
      const auto sub_cell = static_cast<std::uint8_t>(random_.next(4));
      const std::uint8_t before = tiles_.sub_cell[place];
      if (sub_cell == before) continue;
      const std::vector<std::size_t> moved = moved_with(place);
      const std::int64_t old_energy = energy(moved, spectral);
      choose(moved, sub_cell);
      if (energy(moved, spectral) - old_energy > threshold) choose(moved, before);
    }
    settle();
  }

  RandomStream random_;
  std::vector<std::vector<WangNeighbour>> neighbours_;
  std::int64_t least_;  // squared, in units of kBits
  std::array<Wave, kCell> waves_;
  std::vector<Frequency> spectrum_;
  WangTiles tiles_;
  WangTiles::Places<std::vector<std::size_t>> leading_;  // whose point is that of this place
  WangTiles::Places<std::uint64_t> moving_{};            // in which move last
  std::uint64_t move_ = 0;
};

}  // namespace

std::vector<std::vector<WangNeighbour>> wang_neighbours() {
  const auto fits = [](std::size_t a, std::size_t b, std::int64_t tile_x, std::int64_t tile_y) {
    if (tile_x != 0 && tile_y != 0) return true;
    if (tile_x == 0 && tile_y == 0) return a == b;
    if (tile_x < 0 || tile_y < 0) std::swap(a, b);
    const unsigned near = tile_x != 0 ? 1 : 3;  // b lies to the right of a, or above
    return (a >> near & 1) == (b >> (near - 1) & 1);
  };
  std::vector<std::vector<WangNeighbour>> result(kWangPlaces);
  for (std::size_t place = 0; place < kWangPlaces; ++place)
    for (std::int64_t columns : {-1, 0, 1})
      for (std::int64_t rows : {-1, 0, 1}) {
        const std::int64_t x = static_cast<std::int64_t>(place & 3) + columns;
        const std::int64_t y = static_cast<std::int64_t>(place >> 2 & 3) + rows;
        for (std::size_t type = 0; type < kWangTypes; ++type)
          if ((columns != 0 || rows != 0) && fits(place >> 4, type, x >> 2, y >> 2))
            result[place].push_back(
                {type << 4 | static_cast<std::size_t>((x & 3) | (y & 3) << 2), columns, rows});
      }
  return result;
}

WangTiles make_wang_tiles(std::uint64_t seed, double distance) {
  for (std::uint32_t attempt = 0;; ++attempt) {
    Search search(seed, attempt, distance);
    if (search.run()) return search.tiles();
  }
}

}  // namespace koksma
