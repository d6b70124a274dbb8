// star.cl: the star discrepancy D* = sup |vol[0,y) - A([0,y)) / N| from boxes that are given or implied.

// Exact, for points in up to three dimensions (missing ones hold zeros, with the grid {1}). The supremum is
// reached at critical boxes: open ones [0,y) with y on the grid of the points' coordinates and 1, where the
// volume exceeds, and closed ones [0,y], where the count does (Niederreiter 1972, Math. Ann. 194; Gnewuch,
// Srivastav & Winzen 2009, J. Complexity 25). An item takes one coordinate of grid1 and W of grid2
// and walks through the points in ascending order of their last coordinate. Points with equal last
// coordinates need no care: the first of them sees the open count, the last the closed one, and those between
// give less.
//   out[2 * (i1 * blocks2 + block2)], and + 1: the greatest excess of the volume and of the count
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void critical_boxes(
    __global const scalar *restrict x1, __global const scalar *restrict x2,
    __global const scalar *restrict x3, uint n, __global const scalar *restrict grid1, uint size1,
    __global const scalar *restrict grid2, uint blocks2, __global scalar *restrict out) {
  const ulong item = get_global_id(0);
  if (item >= (ulong)size1 * blocks2) return;
  const scalar y1 = grid1[item / blocks2];
  const real y2 = load_lanes(grid2 + item % blocks2 * KOKSMA_LANES_PER_ITEM);
  const real area = (real)y1 * y2, share = (real)((scalar)1 / (scalar)n);
  real open = R(0.0), closed = R(0.0), volume_excess = R(0.0), count_excess = R(0.0);
  for (uint j = 0; j < n; ++j) {
    if (x1[j] > y1) continue;
    const real z = (real)x3[j], b = (real)x2[j];
    volume_excess = fmax(volume_excess, area * z - open * share);
    closed += select_real(b <= y2, R(1.0), R(0.0));
    if (x1[j] < y1) open += select_real(b < y2, R(1.0), R(0.0));
    count_excess = fmax(count_excess, closed * share - area * z);
  }
  volume_excess = fmax(volume_excess, area - open * share);
  scalar lanes[2][KOKSMA_LANES_PER_ITEM], most[2] = {0, 0};
  store_lanes(volume_excess, lanes[0]);
  store_lanes(count_excess, lanes[1]);
  for (uint side = 0; side < 2; ++side)
    for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) most[side] = fmax(most[side], lanes[side][l]);
  out[2 * item] = most[0];
  out[2 * item + 1] = most[1];
}

// The bound that one bracket [lower, upper] gives for every y in it (Thiemard 2001, J. Complexity 17):
//   max(A([0,upper)) / N - vol(lower), vol(upper) - A([0,lower)) / N)
//   x[dimension * padded + point], padding points at 2; brackets[box * 2 * dim]: lower, then upper; out[box]
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void bracket_bounds(
    __global const scalar *restrict x, uint padded, uint dim, uint n,
    __global const scalar *restrict brackets, uint boxes, __global scalar *restrict out) {
  const uint box = get_global_id(0);
  if (box >= boxes) return;
  __global const scalar *lower = brackets + (ulong)box * 2 * dim, *upper = lower + dim;
  real below = R(0.0), within = R(0.0);
  for (uint first = 0; first < padded; first += KOKSMA_LANES_PER_ITEM) {
    real in_lower = R(1.0), in_upper = R(1.0);
    for (uint j = 0; j < dim; ++j) {
      const real a = load_lanes(x + j * padded + first);
      in_lower = select_real(a < (real)lower[j], in_lower, R(0.0));
      in_upper = select_real(a < (real)upper[j], in_upper, R(0.0));
    }
    below += in_lower;
    within += in_upper;
  }
  scalar lanes[2][KOKSMA_LANES_PER_ITEM], counts[2] = {0, 0}, volumes[2] = {1, 1};
  store_lanes(below, lanes[0]);
  store_lanes(within, lanes[1]);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) {
    counts[0] += lanes[0][l];
    counts[1] += lanes[1][l];
  }
  for (uint j = 0; j < dim; ++j) {
    volumes[0] *= lower[j];
    volumes[1] *= upper[j];
  }
  out[box] = fmax(counts[1] / n - volumes[0], volumes[1] - counts[0] / n);
}
