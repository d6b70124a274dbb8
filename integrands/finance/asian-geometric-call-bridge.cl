// asian-geometric-call-bridge: asian-geometric-call with the path built as a Brownian bridge, the end first, then the
// midpoints level by level (Caflisch & Moskowitz 1995; Glasserman 2003, section 3.1). Same law, same exact values.
#ifdef KOKSMA_EXACT
// Level v = 1, 2, ... halves the steps: the times floor(i d / 2^v), i odd, that are new between their neighbours
// floor((i -+ 1) d / 2^v). All levels but the last are full, for any d.
static uint time_at(uint d, uint level, uint i) { return (uint)(((ulong)i * d) >> level); }

static bool bridge_node(uint d, uint level, uint i, uint *left, uint *middle, uint *right) {
  *left = time_at(d, level, i - 1);
  *middle = time_at(d, level, i);
  *right = time_at(d, level, i + 1);
  return *left < *middle && *middle < *right;
}

// The normal of a point moves the log prices between its neighbours like a hat function, whose values at the integer
// times add up to (right - left) / 2; the end moves all in proportion to time.
static double weight_of(params q, uint d, uint j) {
  if (j == 0) return q.sigma * sqrt(q.t) * (d + 1.0) / (2.0 * d);
  uint level = 32 - clz(j), left, middle, right;  // 2^(level - 1) <= j < 2^level
  if (2u << (level - 1) < d) {
    bridge_node(d, level, 2 * (j - (1u << (level - 1))) + 1, &left, &middle, &right);
  } else {
    uint rank = j - (1u << (level - 1)), i = 1;
    while (!bridge_node(d, level, i, &left, &middle, &right) || rank-- > 0) i += 2;
  }
  const double variance = (double)(middle - left) * (right - middle) / (right - left);
  return q.sigma * sqrt(q.t / d * variance) * (right - left) / (2.0 * d);
}
#endif
