// phase-groups: parallel Poisson-disk sampling on the unit torus (L.-Y. Wei, Parallel Poisson disk sampling, SIGGRAPH
// 2008). A grid of G by G cells whose diagonal is the disks' distance r = sqrt(2) / G holds at most one point per cell;
// cells that are 3 apart in both directions cannot conflict, so all cells of one of the 3 by 3 phase groups throw a dart
// at once. Levels go from a coarse grid to the finest, every one with its own r; the points of one stay in the next.
// Coordinates are 32-bit fractions and squared distances 64-bit integers: the same set on every device.
// Buffers of all kernels: points [K][2], fractions of 64 bits, then their number; cells [2][G][G][2], which levels use
// in turn: [0] x << 32 | y, [1] when the point came, 0 in an empty cell: trial << 32 | random 32 bits.

static inline ulong squared_on_circle(uint a, uint b) {
  const uint d = min(a - b, b - a);
  return (ulong)d * d;
}

static inline uint cell_of(uint coordinate, ulong grid) { return (uint)(coordinate * grid >> 32); }

// A place in cell number `cell` of a row: its 32-bit fractions are those with cell_of(x) == cell.
static inline uint place_in(ulong cell, ulong grid, uint random) {
  const ulong begin = ((cell << 32) + grid - 1) / grid, end = (((cell + 1) << 32) + grid - 1) / grid;
  return (uint)(begin + ((end - begin) * random >> 32));
}

// Item (x, y) of the finer grid takes over the point of the coarser one that lies in its cell.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void refine(
    __global ulong *restrict points, __global ulong *restrict cells, ulong grid, ulong from, ulong to) {
  const ulong at = get_global_id(0);
  if (at >= grid * grid) return;
  const ulong x = at % grid, y = at / grid, coarse = grid / 2;
  __global const ulong *source = cells + from + 2 * (y / 2 * coarse + x / 2);
  const ulong position = source[0];
  const uint stays = source[1] != 0 && cell_of((uint)(position >> 32), grid) == x && cell_of((uint)position, grid) == y;
  cells[to + 2 * at] = position * stays;
  cells[to + 2 * at + 1] = source[1] * stays;
}

// Item i: a dart into the i-th cell of phase group (phase_x, phase_y), if it is empty.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void throw_darts(
    __global ulong *restrict points, __global ulong *restrict cells, ulong grid, ulong at, ulong phase, ulong trial,
    ulong squared_distance, ulong seed) {
  const ulong groups = grid / 3, item = get_global_id(0);
  if (item >= groups * groups) return;
  const ulong x = item % groups * 3 + phase % 3, y = item / groups * 3 + phase / 3;
  __global ulong *own = cells + at + 2 * (y * grid + x);
  if (own[1] != 0) return;
  words32 random[4];
  philox_rounds((uint)item, (uint)trial, seed, 0, 10u << 24 | 1, random);
  const uint dart_x = place_in(x, grid, random[0]), dart_y = place_in(y, grid, random[1]);
  for (uint row = 0; row < 5; ++row) {
    for (uint column = 0; column < 5; ++column) {
      const ulong cell = (y + row + grid - 2) % grid * grid + (x + column + grid - 2) % grid;
      __global const ulong *other = cells + at + 2 * cell;
      if (other[1] == 0) continue;
      if (squared_on_circle(dart_x, (uint)(other[0] >> 32)) + squared_on_circle(dart_y, (uint)other[0]) <
          squared_distance)
        return;
    }
  }
  own[0] = (ulong)dart_x << 32 | dart_y;
  own[1] = trial << 32 | random[2];
}

// Item (x, y): its point's place in the set is the number of points that came before it.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void collect(
    __global ulong *restrict points, __global ulong *restrict cells, ulong grid, ulong at, ulong size) {
  const ulong item = get_global_id(0), all = grid * grid;
  if (item >= all) return;
  __global const ulong *cell = cells + at;
  const ulong came = cell[2 * item + 1];
  ulong before = 0, occupied = 0;
  for (ulong other = 0; other < all; ++other) {
    const ulong others = cell[2 * other + 1];
    before += others != 0 && (others < came || (others == came && other < item));
    occupied += others != 0;
  }
  if (item == 0) points[2 * size] = min(occupied, size);
  if (came == 0 || before >= size) return;
  points[2 * before] = cell[2 * item] >> 32 << 32;
  points[2 * before + 1] = cell[2 * item] << 32;
}
