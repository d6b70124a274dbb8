// Recursive Wang tiles with one point in every cell (harness/points/wang.cpp ranks the points of a
// tile). A rule cuts each of 16 tiles, of two colours per direction, into 4 x 4 cells that are such
// tiles again and fit wherever the tiles did (J. Kopf, D. Cohen-Or, O. Deussen & D. Lischinski,
// Recursive Wang tiles for real-time blue noise, SIGGRAPH 2006). The point of a cell is
// the point of one of the cell's own 16 cells, so that the points of a level are among those of the
// next, exactly: the choice of the sub-cells is an iterated function system, and its fixed point
// are the positions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace koksma {

inline constexpr std::size_t kWangTypes = 16;  // left | right << 1 | lower << 2 | upper << 3
inline constexpr std::size_t kWangCells = 16;  // of a tile: column | row << 2
inline constexpr std::size_t kWangPlaces = kWangTypes * kWangCells;  // type << 4 | cell

struct WangTiles {
  template <typename T>
  using Places = std::array<T, kWangPlaces>;
  Places<std::uint8_t> type;      // of the cell, a tile itself
  Places<std::uint8_t> sub_cell;  // of the cell, where its point is
  Places<std::uint32_t> x, y;     // the point's place in the cell, in units of 2^-32 of its side

  // Of the cell's tile the cell that holds the point.
  std::size_t next(std::size_t place) const {
    return std::size_t{type[place]} << 4 | sub_cell[place];
  }
};

// A cell beside another, in the same tile or in one that may lie beside it.
struct WangNeighbour {
  std::size_t place;
  std::int64_t columns, rows;  // its offset, -1, 0 or 1 cells
};

// [place]: all that may be there, over all tilings. Diagonal tiles share no edge: any may be there.
std::vector<std::vector<WangNeighbour>> wang_neighbours();

// Tiles whose points keep at least `distance`, in cells, from every neighbour's, and have little
// power at low frequencies. With 0.75 the first attempt succeeded for each of 2000 seeds, in 0.07 s
// on average (measured 2026-11-24); near 0.8 it begins to take more attempts, and never ends where
// a distance can not be had.
WangTiles make_wang_tiles(std::uint64_t seed, double distance);

}  // namespace koksma
