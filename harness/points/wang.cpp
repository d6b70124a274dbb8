// Table of the wang family (kernels/points/wang.cl): the rule of the recursive tiles and, for each
// of them, its 256 points in a progressive order. The first 16 are the tile's own, one in every
// cell; the others are those that its cells have as tiles themselves, so that what is added on a
// level makes it the next.
#include <algorithm>
#include <cstdint>

#include "points/tables.hpp"
#include "points/wang_tiles.hpp"

namespace koksma {
namespace {

constexpr std::size_t kRanks = kWangCells * kWangCells;
constexpr std::int64_t kCellSide = std::int64_t{1} << 32;  // units of a cell's side

// Cells in the order of a dither matrix (B. E. Bayer, ICC 1973), so that the points that a round
// over them has added are spread well at any time: bits 0 and 1 say the quarter, diagonal ones one
// after the other, bits 2 and 3 the quarter's.
std::size_t dithered_cell(std::size_t k) {
  const auto halves = [](std::size_t bits) { return (bits & 1) << 1 | (bits >> 2 & 1); };
  return halves(k) | halves(k ^ k >> 1) << 2;
}

class Ranking {
 public:
  explicit Ranking(const WangTiles& tiles) : tiles_(tiles), neighbours_(wang_neighbours()) {
    for (std::size_t place = 0; place < kWangPlaces; ++place)
      for (std::size_t s = 0; s < kWangCells; ++s) {
        const std::size_t next = std::size_t{tiles.type[place]} << 4 | s;
        points_[place][s].x = static_cast<std::uint32_t>(s & 3) << 30 | tiles.x[next] >> 2;
        points_[place][s].y = static_cast<std::uint32_t>(s >> 2) << 30 | tiles.y[next] >> 2;
      }
    for (std::size_t rank = 0; rank < kRanks; ++rank)
      for (std::size_t type = 0; type < kWangTypes; ++type) {
        const std::size_t cell = dithered_cell(rank % kWangCells);
        take(type << 4 | cell, rank < kWangCells);
      }
  }

  // [rank][type], in units of 2^-32 of the tile's side.
  const std::vector<std::uint64_t>& x() const { return x_; }
  const std::vector<std::uint64_t>& y() const { return y_; }

 private:
  struct Point {
    std::int64_t x = 0, y = 0;         // in the cell, in units of 2^-32
    std::int64_t nearest = INT64_MAX;  // squared distance of the nearest point that has a rank
    bool ranked = false;
  };

  void take(std::size_t place, bool own) {
    auto& points = points_[place];
    Point* best = &points[tiles_.sub_cell[place]];
    // Farthest first of those that have no rank (T. F. Gonzalez, Theor. Comput. Sci. 38, 1985).
    for (Point& p : points)
      if (!own && !p.ranked && (best->ranked || p.nearest > best->nearest)) best = &p;
    best->ranked = true;
    const std::size_t at = ranks_[place >> 4]++ * kWangTypes + (place >> 4);
    x_[at] = (place & 3) << 30 | static_cast<std::uint64_t>(best->x) >> 2;
    y_[at] = (place >> 2 & 3) << 30 | static_cast<std::uint64_t>(best->y) >> 2;
    see(*best, {place, 0, 0});
    for (const WangNeighbour& n : neighbours_[place]) see(*best, n);
  }

  // A point that has a rank now, from what lies beside its cell.
  void see(const Point& ranked, const WangNeighbour& n) {
    constexpr unsigned kCut = 4;  // so that squares have room
    for (Point& p : points_[n.place]) {
      const std::int64_t dx = (p.x + n.columns * kCellSide - ranked.x) >> kCut;
      const std::int64_t dy = (p.y + n.rows * kCellSide - ranked.y) >> kCut;
      p.nearest = std::min(p.nearest, dx * dx + dy * dy);
    }
  }

  std::vector<std::uint64_t> x_ = std::vector<std::uint64_t>(kWangTypes * kRanks), y_ = x_;
  const WangTiles& tiles_;
  std::vector<std::vector<WangNeighbour>> neighbours_;
  WangTiles::Places<std::array<Point, kWangCells>> points_;
  std::array<std::size_t, kWangTypes> ranks_{};
};

}  // namespace

PointTable build_wang(const PointRequest& request) {
  const WangTiles tiles = make_wang_tiles(request.seed, request.options.at("minimum_distance"));
  PointTable table;
  // Eight types a word.
  for (const std::size_t half : {0U, 8U})
    for (std::size_t cell = 0; cell < kWangCells; ++cell) {
      std::uint64_t word = 0;
      for (std::size_t k = 0; k < 8; ++k)
        word |= std::uint64_t{tiles.type[(half + k) << 4 | cell]} << 4 * k;
      table.words.push_back(word);
    }
  const Ranking ranking(tiles);
  table.words.insert(table.words.end(), ranking.x().begin(), ranking.x().end());
  table.words.insert(table.words.end(), ranking.y().begin(), ranking.y().end());
  return table;
}

}  // namespace koksma
