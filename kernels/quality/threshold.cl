// threshold.cl: lower bounds of the star discrepancy by threshold accepting, one chain of boxes per
// work-item (Winker & Fang 1997, SIAM J. Numer. Anal. 34; Gnewuch, Wahlstroem & Winzen 2012, SIAM J. Numer.
// Anal. 50). From the latter: open and closed boxes are searched apart, every box is snapped to a
// critical one, neighbourhoods shrink from half the grid to one step while the number of coordinates that
// move grows from 2 to d, thresholds come from sampled differences. Not theirs: coordinates are snapped in a
// rotated instead of a random order. Whatever the search does, its best box is a box, so the value is a bound.
//
// Boxes are kept as ranks in the sorted coordinates of each dimension, with 1 as the top rank:
//   rank[dimension * padded + point] (padding points above every rank), grid[dimension * grid_stride + rank],
//   top[dimension]
typedef struct {
  __global const scalar *rank, *grid;
  __global const uint *top;
  __global scalar *outside;  // per point: coordinates in which it lies outside the present box
  uint n, padded, dim, grid_stride;
  ulong random;
} search;

// SplitMix64 (Steele, Lea & Flood 2014, OOPSLA).
static inline ulong draw(search *s) {
  s->random += 0x9E3779B97F4A7C15UL;
  ulong z = s->random;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9UL;
  z = (z ^ z >> 27) * 0x94D049BB133111EBUL;
  return z ^ z >> 31;
}

// 0 ... count-1; the bias of 2^-32 count does not matter to a search.
static inline uint draw_below(search *s, uint count) { return (uint)((draw(s) >> 32) * count >> 32); }

static inline scalar volume_of(const search *s, __global const scalar *box) {
  scalar volume = 1;
  for (uint j = 0; j < s->dim; ++j) volume *= s->grid[j * s->grid_stride + (uint)box[j]];
  return volume;
}

// Fills `outside`, and returns the number of points inside; closed boxes hold their upper faces.
static uint count_inside(search *s, __global const scalar *box, uint closed) {
  uint inside = 0;
  for (uint first = 0; first < s->padded; first += KOKSMA_LANES_PER_ITEM) {
    real out = R(0.0);
    for (uint j = 0; j < s->dim; ++j) {
      // Ranks are whole numbers: r > y - 1 says r >= y.
      const real bound = (real)(closed != 0 ? box[j] : box[j] - 1);
      out += select_real(load_lanes(s->rank + j * s->padded + first) > bound, R(1.0), R(0.0));
    }
    store_lanes(out, s->outside + first);
    inside += count_lanes(out < R(0.5));
  }
  return inside;
}

// Raises every coordinate of an open box to the first point that it would take in: more volume, the same count.
static void grow(search *s, __global scalar *box) {
  const uint start = draw_below(s, s->dim);
  for (uint i = 0; i < s->dim; ++i) {
    const uint j = (start + i) % s->dim;
    __global const scalar *rank = s->rank + j * s->padded;
    const real old = (real)box[j];
    real least = (real)(scalar)s->top[j];
    for (uint first = 0; first < s->padded; first += KOKSMA_LANES_PER_ITEM) {
      const real r = load_lanes(rank + first), out = load_lanes(s->outside + first);
      const real candidate = select_real(r < old, least, r);
      least = select_real(fabs(out - R(1.0)) < R(0.5), fmin(least, candidate), least);
    }
    scalar lanes[KOKSMA_LANES_PER_ITEM];
    store_lanes(least, lanes);
    for (uint l = 1; l < KOKSMA_LANES_PER_ITEM; ++l) lanes[0] = fmin(lanes[0], lanes[l]);
    if (lanes[0] == box[j]) continue;
    box[j] = lanes[0];
    for (uint first = 0; first < s->padded; first += KOKSMA_LANES_PER_ITEM) {
      const real r = load_lanes(rank + first);
      const real entered = select_real(r < old, R(0.0), select_real(r < (real)lanes[0], R(1.0), R(0.0)));
      store_lanes(load_lanes(s->outside + first) - entered, s->outside + first);
    }
  }
}

// Lowers every coordinate of a closed box to the last point inside: less volume, the same count.
static void shrink(search *s, __global scalar *box) {
  for (uint j = 0; j < s->dim; ++j) {
    real most = R(0.0);
    for (uint first = 0; first < s->padded; first += KOKSMA_LANES_PER_ITEM)
      most = select_real(load_lanes(s->outside + first) < R(0.5),
                         fmax(most, load_lanes(s->rank + j * s->padded + first)), most);
    scalar lanes[KOKSMA_LANES_PER_ITEM];
    store_lanes(most, lanes);
    for (uint l = 1; l < KOKSMA_LANES_PER_ITEM; ++l) lanes[0] = fmax(lanes[0], lanes[l]);
    box[j] = lanes[0];
  }
}

// The excess, of the volume (open) or of the count (closed), of the critical box that `from` snaps to.
static scalar snapped_excess(search *s, __global const scalar *from, __global scalar *box, uint closed) {
  for (uint j = 0; j < s->dim; ++j) box[j] = from[j];
  const uint inside = count_inside(s, box, closed);
  const scalar share = (scalar)inside / (scalar)s->n;
  if (closed == 0) {
    grow(s, box);
    return volume_of(s, box) - share;
  }
  if (inside > 0) shrink(s, box);
  return share - volume_of(s, box);
}

// A box whose coordinates are distributed as u^(1/d), so that volumes are not all near 0.
static void random_box(search *s, __global scalar *box) {
  for (uint j = 0; j < s->dim; ++j) {
    const scalar u = (scalar)(draw(s) >> 41) / (scalar)(1 << 23);
    box[j] = fmin(floor(pow(u, (scalar)1 / (scalar)s->dim) * (scalar)(s->top[j] + 1)), (scalar)s->top[j]);
  }
}

// progress goes from 0 to 1 over a search.
static void neighbour(search *s, __global const scalar *box, __global scalar *trial, scalar progress) {
  for (uint j = 0; j < s->dim; ++j) trial[j] = box[j];
  const uint most = s->dim > 2 ? s->dim - 2 : 0;
  const uint moves = min(s->dim, 2 + (uint)(progress * (scalar)most + (scalar)0.5f));
  for (uint i = 0; i < moves; ++i) {
    const uint j = draw_below(s, s->dim), top = s->top[j];
    const uint reach = 1 + (uint)((1 - progress) * (scalar)(top / 2));
    const scalar step = (scalar)draw_below(s, 2 * reach + 1) - (scalar)reach;
    trial[j] = fmin(fmax(box[j] + step, (scalar)0), (scalar)top);
  }
}

// scratch: per chain padded + 3 * dim + rounds scalars. Even chains search open boxes, odd ones closed.
//   box[chain * dim]: the best of rounds * rounds boxes; the seed and the chain start the random numbers
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void threshold_accepting(
    __global const scalar *restrict rank, __global const scalar *restrict grid,
    __global const uint *restrict top, uint n, uint padded, uint dim, uint grid_stride, uint chains,
    uint rounds, ulong seed, __global scalar *restrict scratch, __global scalar *restrict box) {
  const uint chain = get_global_id(0), closed = chain & 1;
  if (chain >= chains) return;
  __global scalar *own = scratch + (ulong)chain * (padded + 3 * dim + rounds);
  search s = {rank, grid, top, own, n, padded, dim, grid_stride, seed + ((ulong)(chain + 1) << 40)};
  __global scalar *present = own + padded, *trial = present + dim, *snapped = trial + dim;
  __global scalar *threshold = snapped + dim;

  // Thresholds: differences between random boxes and neighbours, ascending from the most tolerant to 0.
  for (uint t = 0; t < rounds; ++t) {
    random_box(&s, present);
    const scalar here = snapped_excess(&s, present, snapped, closed);
    neighbour(&s, present, trial, (scalar)t / (scalar)rounds);
    const scalar difference = -fabs(snapped_excess(&s, trial, snapped, closed) - here);
    uint at = t;
    for (; at > 0 && threshold[at - 1] > difference; --at) threshold[at] = threshold[at - 1];
    threshold[at] = difference;
  }

  random_box(&s, present);
  scalar here = snapped_excess(&s, present, snapped, closed), best = here;
  for (uint j = 0; j < dim; ++j) box[chain * dim + j] = snapped[j];
  for (uint t = 0; t < rounds; ++t)
    for (uint i = 0; i < rounds; ++i) {
      neighbour(&s, present, trial, ((scalar)t + (scalar)i / (scalar)rounds) / (scalar)rounds);
      const scalar there = snapped_excess(&s, trial, snapped, closed);
      if (there > best) {
        best = there;
        for (uint j = 0; j < dim; ++j) box[chain * dim + j] = snapped[j];
      }
      if (there - here < threshold[t]) continue;
      here = there;
      // Open boxes go on from the snapped one, which no small step empties. Closed ones must not: shrunk to their
      // points, hardly a step would take in another (measured: a third of the excess lost at d = 5, N = 12).
      for (uint j = 0; j < dim; ++j) present[j] = closed != 0 ? trial[j] : snapped[j];
    }
}
