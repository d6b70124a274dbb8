// candidates: Mitchell's best candidate (Spectrally optimal sampling for distribution ray tracing, SIGGRAPH 1991) on
// the unit torus: of c n + 1 uniform candidates, point n is the one farthest from points 0 ... n - 1.
// Coordinates are 32-bit fractions and squared distances 64-bit integers, so that the set is the same on every device;
// ties go to the first candidate. Points hang in the lists of a grid of 2^log2_cells by 2^log2_cells cells.
// Buffers of all kernels: points [K][2], fractions of 64 bits, then their number; best [groups][2]: squared distance
// and number of the best of 16 candidates; heads [cells] and next [K]: 1 + point, 0 ends a list.
#define KOKSMA_CANDIDATES_PER_ITEM 16

static inline ulong squared_on_circle(uint a, uint b) {
  const uint d = min(a - b, b - a);
  return (ulong)d * d;
}

static inline void candidate(uint n, uint m, ulong seed, uint position[2]) {
  words32 random[4];
  philox_rounds(m, n, seed, 0, 10u << 24, random);
  position[0] = random[0];
  position[1] = random[1];
}

static inline uint cell_of(uint coordinate, uint log2_cells) { return (uint)((ulong)coordinate << log2_cells >> 32); }

// The squared distance of the nearest point: rings of cells around the position, until no farther one can hold it.
static inline ulong nearest(const uint position[2], __global const ulong *points, __global const uint *heads,
                            __global const uint *next, uint log2_cells) {
  const uint cells = 1u << log2_cells;
  const uint x = cell_of(position[0], log2_cells), y = cell_of(position[1], log2_cells);
  ulong best = (ulong)1 << 63;
  for (uint ring = 0; 2 * ring < cells + 2; ++ring) {
    for (uint row = 0; row <= 2 * ring; ++row) {
      uint stride = 1;
      if (row != 0 && row != 2 * ring) stride = 2 * ring;
      for (uint column = 0; column <= 2 * ring; column += stride) {
        const uint cell = ((y + row - ring) & (cells - 1)) << log2_cells | ((x + column - ring) & (cells - 1));
        for (uint at = heads[cell]; at != 0; at = next[at - 1])
          best = min(best, squared_on_circle(position[0], (uint)(points[2 * at - 2] >> 32)) +
                               squared_on_circle(position[1], (uint)(points[2 * at - 1] >> 32)));
      }
    }
    // What no ring has reached so far is at least `ring` cells away.
    const ulong reached = (ulong)ring << (32 - log2_cells);
    if (reached < 0x80000000UL && best <= reached * reached) break;
  }
  return best;
}

static inline void hang(__global const ulong *points, __global uint *heads, __global uint *next, uint point,
                        uint log2_cells) {
  const uint x = cell_of((uint)(points[2 * point] >> 32), log2_cells);
  const uint y = cell_of((uint)(points[2 * point + 1] >> 32), log2_cells);
  const uint cell = y << log2_cells | x;
  next[point] = heads[cell];
  heads[cell] = point + 1;
}

// One item: the first n points into a grid of another size.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void regrid(
    __global ulong *restrict points, __global ulong *restrict best, __global uint *restrict heads,
    __global uint *restrict next, ulong n, ulong log2_cells) {
  if (get_global_id(0) != 0) return;
  for (uint cell = 0; cell < 1u << 2 * log2_cells; ++cell) heads[cell] = 0;
  for (uint point = 0; point < n; ++point) hang(points, heads, next, point, (uint)log2_cells);
}

// Item g: the best of candidates 16 g ... 16 g + 15 for point n.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void rate(
    __global ulong *restrict points, __global ulong *restrict best, __global uint *restrict heads,
    __global uint *restrict next, ulong n, ulong candidates, ulong log2_cells, ulong seed) {
  const uint first = (uint)get_global_id(0) * KOKSMA_CANDIDATES_PER_ITEM;
  if (first >= candidates) return;
  const uint end = min(first + KOKSMA_CANDIDATES_PER_ITEM, (uint)candidates);
  ulong farthest = 0, chosen = first;
  for (uint m = first; m < end; ++m) {
    uint position[2];
    candidate((uint)n, m, seed, position);
    const ulong distance = nearest(position, points, heads, next, (uint)log2_cells);
    if (distance <= farthest) continue;
    farthest = distance;
    chosen = m;
  }
  const ulong group = get_global_id(0);
  best[2 * group] = farthest;
  best[2 * group + 1] = chosen;
}

// One item: point n is the best of all candidates.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void take(
    __global ulong *restrict points, __global ulong *restrict best, __global uint *restrict heads,
    __global uint *restrict next, ulong n, ulong groups, ulong log2_cells, ulong seed, ulong size) {
  if (get_global_id(0) != 0) return;
  ulong chosen = 0;
  for (ulong g = 1; g < groups; ++g)
    if (best[2 * g] > best[2 * chosen]) chosen = g;
  uint position[2];
  candidate((uint)n, (uint)best[2 * chosen + 1], seed, position);
  points[2 * n] = (ulong)position[0] << 32;
  points[2 * n + 1] = (ulong)position[1] << 32;
  points[2 * size] = n + 1;
  hang(points, heads, next, (uint)n, (uint)log2_cells);
}
