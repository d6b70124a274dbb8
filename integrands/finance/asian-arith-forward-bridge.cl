// asian-arith-forward-bridge: asian-arith-forward with the path built as a Brownian bridge (Caflisch & Moskowitz 1995;
// Glasserman 2003, section 3.1), depth first: a point needs only its ancestors in the tree of midpoints, one per level.
// Draw k takes the dimension that the usual order gives its point: the end first, then midpoints level by level.
#ifdef KOKSMA_EXACT
// Slots of the log prices on the path from the root: the end in 0, the present point of level v in v.
#define SLOT_OF_ZERO 14u
#define SLOT_OF_ONE 15u

// Level v = 1, 2, ... halves the steps: the times floor(i d / 2^v), i odd, that are new between their neighbours
// floor((i -+ 1) d / 2^v). All levels but the last are full, for any d.
static uint time_at(uint d, uint level, uint i) { return (uint)(((ulong)i * d) >> level); }

static uint zeros_below(uint i) { return popcount((i & -i) - 1); }

// The point of draw k >= 1: its level, its odd i, and its place in the order by levels. Depth first means: before the
// place u on the last level, the points whose left branch leads there, downwards.
static uint node_of(uint d, uint k, uint *level, uint *i) {
  const uint levels = 32 - clz(d - 1);
  uint drawn = 0, rank = 1u << (levels - 1);
  for (uint u = 0; u < 1u << (levels - 1); ++u) {
    for (*level = u == 0 ? 1 : levels - zeros_below(u); *level < levels; ++*level) {
      *i = 2 * (u >> (levels - *level)) + 1;
      if (++drawn == k) return (1u << (*level - 1)) + *i / 2;
    }
    *i = 2 * u + 1;
    const uint middle = time_at(d, levels, *i);
    if (time_at(d, levels, *i - 1) == middle || middle == time_at(d, levels, *i + 1)) continue;
    if (++drawn == k) return rank;
    ++rank;
  }
  return 0;
}

static uint dimension_order(params q, uint d, uint k) {
  uint level, i;
  return k == 0 ? 0 : node_of(d, k, &level, &i);
}

// The slot of the neighbour i -+ 1 of a point of this level.
static uint neighbour_slot(uint level, uint i) { return i == 0 ? SLOT_OF_ZERO : level - zeros_below(i); }

// log(S / s0) = left * (left neighbour) + right * (right neighbour) + deviation * normal. The drift enters at the end
// alone, as the weight of the slot that holds 1: between two points the mean is linear in time.
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[4] = q.s0 * exp(-q.r * q.t) / d;
  if (j == 0) {
    c[0] = 0;
    c[1] = (q.r - q.sigma * q.sigma / 2) * q.t;
    c[2] = q.sigma * sqrt(q.t);
    c[3] = SLOT_OF_ZERO + 16 * SLOT_OF_ONE;
    return;
  }
  uint level, i;
  node_of(d, j, &level, &i);
  const double left = time_at(d, level, i - 1), middle = time_at(d, level, i), right = time_at(d, level, i + 1);
  c[0] = (right - middle) / (right - left);
  c[1] = (middle - left) / (right - left);
  c[2] = q.sigma * sqrt(q.t / d * (middle - left) * (right - middle) / (right - left));
  c[3] = neighbour_slot(level, i - 1) + 16 * neighbour_slot(level, i + 1) + 256 * level;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real slots[16], sum = R(0.0);  // 2^13 >= d and two constants
  slots[14] = R(0.0);
  slots[15] = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const uint at = (uint)c[5 * j + 3];
    const real ends = fma((real)c[5 * j], slots[at & 15], c[5 * j + 1] * slots[at >> 4 & 15]);
    const real path = fma((real)c[5 * j + 2], normal_quantile(points_next(p)), ends);
    slots[at >> 8] = path;
    sum += exp(path);
  }
  return c[4] * sum;
}
#endif
