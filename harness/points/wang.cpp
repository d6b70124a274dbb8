// Tables of the wang family (kernels/points/wang.cl): Poisson-disk patterns on the 16 Wang tiles of
// two colours per direction, with progressive ranks. The plane is cut, not along the tiles' edges,
// but into what lies about a corner, about a vertical edge, about a horizontal edge, and the
// interiors (S. Hiller, O. Deussen & A. Keller, Tiled blue noise samples, VMV 2001, keep strips
// along edges too). The edges' pieces are shared by all tiles of their colour, so neighbours agree;
// pieces that lie apart are farther from each other than the disks' distance.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "points/tables.hpp"

namespace koksma {
namespace {

constexpr std::uint32_t kBlock = 5;  // of the stream of point sets
constexpr std::uint64_t kMostDarts = std::uint64_t{1} << 16;
constexpr std::int64_t kTile = std::int64_t{1} << 30;  // units of a tile's side
constexpr std::int64_t kHalfStrip = kTile / 16;
constexpr std::size_t kTypes = 16;

enum Kind : std::size_t { corner, vertical, horizontal, interior, kKinds };
constexpr std::array<std::size_t, kKinds> kVariants{1, 2, 2, kTypes};

struct Position {
  std::int64_t x, y;
};

struct Point {
  Position at;
  std::int64_t nearest = INT64_MAX;  // squared distance of the nearest point that has a rank
  bool ranked = false;
};

// One variant of one kind, where a tile at (0, 0) has it.
struct Piece {
  Kind kind;
  std::size_t variant;
  std::vector<Point> points;
};

// Piece b at this offset, in tiles, can lie beside piece a at (0, 0).
struct Sight {
  std::size_t a, b;
  Position offset;
};

std::int64_t squared(const Position& p, const Position& q, const Position& offset) {
  const std::int64_t dx = q.x + offset.x * kTile - p.x, dy = q.y + offset.y * kTile - p.y;
  return dx * dx + dy * dy;
}

class Patterns {
 public:
  Patterns(std::uint64_t seed, std::size_t ranks, double distance)
      : seed_(seed),
        ranks_(ranks),
        least_(
            static_cast<std::int64_t>(std::ceil(distance * distance / static_cast<double>(ranks) *
                                                static_cast<double>(kTile) * kTile))) {
    for (std::size_t kind = 0; kind < kKinds; ++kind)
      for (std::size_t v = 0; v < kVariants[kind]; ++v)
        pieces_.push_back({static_cast<Kind>(kind), v, {}});
    find_sights();
    for (std::uint32_t attempt = 0; !fill(attempt); ++attempt)
      for (Piece& piece : pieces_) piece.points.clear();
    rank();
  }

  // [type][rank]
  const std::vector<std::vector<Position>>& tiles() const { return tiles_; }

 private:
  static std::size_t first(Kind kind) {
    std::size_t index = 0;
    for (std::size_t k = 0; k < kind; ++k) index += kVariants[k];
    return index;
  }

  // Points of a piece of this kind: the ranks, by area.
  std::size_t count(Kind kind) const {
    const std::size_t wide = 16 - 2, narrow = 2;  // sixteenths of a tile
    const std::size_t width = kind == vertical || kind == corner ? narrow : wide;
    const std::size_t height = kind == horizontal || kind == corner ? narrow : wide;
    return ranks_ * width * height / 256;
  }

  void see(std::size_t a, std::size_t b, std::int64_t x, std::int64_t y) {
    sights_.push_back({a, b, {x, y}});
    if (a != b) sights_.push_back({b, a, {-x, -y}});
  }

  void find_sights() {
    for (std::size_t i = 0; i < pieces_.size(); ++i) see(i, i, 0, 0);
    for (std::size_t v = 0; v < 2; ++v) {
      for (const std::int64_t step : {0, 1}) {
        see(first(corner), first(vertical) + v, 0, -step);
        see(first(corner), first(horizontal) + v, -step, 0);
      }
      for (std::size_t h = 0; h < 2; ++h)
        for (const std::int64_t x : {0, -1})
          for (const std::int64_t y : {0, 1}) see(first(vertical) + v, first(horizontal) + h, x, y);
    }
    for (std::size_t type = 0; type < kTypes; ++type) {
      const std::size_t inside = first(interior) + type;
      for (const std::int64_t x : {0, 1})
        for (const std::int64_t y : {0, 1}) see(inside, first(corner), x, y);
      see(inside, first(vertical) + (type & 1), 0, 0);
      see(inside, first(vertical) + (type >> 1 & 1), 1, 0);
      see(inside, first(horizontal) + (type >> 2 & 1), 0, 0);
      see(inside, first(horizontal) + (type >> 3 & 1), 0, 1);
    }
  }

  Position dart(Kind kind, const RandomPair& random) const {
    const auto place = [](std::uint64_t word, bool strip) {
      const std::int64_t begin = strip ? -kHalfStrip : kHalfStrip;
      const std::int64_t length = strip ? 2 * kHalfStrip : kTile - 2 * kHalfStrip;
      return begin +
             static_cast<std::int64_t>((word >> 32) * static_cast<std::uint64_t>(length) >> 32);
    };
    return {place(random.first, kind == vertical || kind == corner),
            place(random.second, kind == horizontal || kind == corner)};
  }

  // True when no point in sight is too near.
  bool fits(std::size_t index, const Position& at) const {
    return std::all_of(sights_.begin(), sights_.end(), [&](const Sight& s) {
      return s.a != index ||
             std::all_of(pieces_[s.b].points.begin(), pieces_[s.b].points.end(),
                         [&](const Point& p) { return squared(at, p.at, s.offset) >= least_; });
    });
  }

  // Darts into one piece after the other; false when a point found no room.
  bool fill(std::uint32_t attempt) {
    for (std::size_t index = 0; index < pieces_.size(); ++index) {
      Piece& piece = pieces_[index];
      for (std::uint64_t n = 0; n < count(piece.kind); ++n) {
        bool found = false;
        for (std::uint64_t i = 0; i < kMostDarts && !found; ++i) {
          const RandomPair random = random_pair(seed_, (index << 16 | n) << 16 | i, attempt,
                                                RandomPurpose::point_set, kBlock);
          const Position at = dart(piece.kind, random);
          found = fits(index, at);
          if (found) piece.points.push_back({at});
        }
        if (!found) return false;
      }
    }
    return true;
  }

  // The kind of every rank, the same in all tiles: in proportion to the points of the kinds.
  Kind kind_of(std::size_t rank, const std::array<std::size_t, kKinds>& used) const {
    std::size_t best = 0;
    std::int64_t most = INT64_MIN;
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      const auto due = static_cast<std::int64_t>((rank + 1) * count(static_cast<Kind>(kind))) -
                       static_cast<std::int64_t>(used[kind] * ranks_);
      if (due > most) best = kind, most = due;
    }
    return static_cast<Kind>(best);
  }

  // Farthest first: of every variant the point that is farthest from all points in sight that have
  // a rank already (Gonzalez 1985); that makes the patterns progressive.
  void rank() {
    tiles_.assign(kTypes, {});
    std::array<std::size_t, kKinds> used{};
    for (std::size_t r = 0; r < ranks_; ++r) {
      const Kind kind = kind_of(r, used);
      ++used[kind];
      std::vector<Position> chosen;
      for (std::size_t v = 0; v < kVariants[kind]; ++v) chosen.push_back(take(first(kind) + v));
      for (std::size_t type = 0; type < kTypes; ++type) {
        const std::size_t v = kind == corner       ? 0
                              : kind == vertical   ? type & 1
                              : kind == horizontal ? type >> 2 & 1
                                                   : type;
        tiles_[type].push_back(chosen[v]);
      }
    }
  }

  Position take(std::size_t index) {
    std::vector<Point>& points = pieces_[index].points;
    Point* best = nullptr;
    for (Point& p : points)
      if (!p.ranked && (best == nullptr || p.nearest > best->nearest)) best = &p;
    best->ranked = true;
    for (const Sight& s : sights_) {
      if (s.a != index) continue;
      for (Point& p : pieces_[s.b].points)
        p.nearest = std::min(p.nearest, squared(best->at, p.at, s.offset));
    }
    return best->at;
  }

  std::uint64_t seed_;
  std::size_t ranks_;
  std::int64_t least_;  // squared
  std::vector<Piece> pieces_;
  std::vector<Sight> sights_;
  std::vector<std::vector<Position>> tiles_;
};

}  // namespace

PointTable build_wang(const PointRequest& request) {
  const std::size_t ranks = request.options.at("points");
  const Patterns patterns(request.seed, ranks, request.options.at("minimum_distance"));
  PointTable table;
  table.words.push_back(static_cast<std::uint64_t>(std::countr_zero(ranks)));
  for (const bool is_y : {false, true})
    for (const std::vector<Position>& tile : patterns.tiles())
      for (const Position& p : tile)
        table.words.push_back(static_cast<std::uint64_t>((is_y ? p.y : p.x) + kTile));
  return table;
}

}  // namespace koksma
