// pairs.cl: sums and extremes over all pairs of points, for any dimension at run time.
//   x[dimension * padded + point], weight[point]: 1, and 0 for the points that pad a column to whole vectors
// A work-item takes one point m and the points from its own vector on, W at a time: pairs inside that
// vector come up in both orders, later ones once, so they count twice.

static inline scalar lane_sum(real v) {
  scalar lanes[KOKSMA_LANES_PER_ITEM], sum = 0;
  store_lanes(v, lanes);
  for (uint l = 0; l < KOKSMA_LANES_PER_ITEM; ++l) sum += lanes[l];
  return sum;
}

static inline scalar lane_minimum(real v) {
  scalar lanes[KOKSMA_LANES_PER_ITEM];
  store_lanes(v, lanes);
  scalar least = lanes[0];
  for (uint l = 1; l < KOKSMA_LANES_PER_ITEM; ++l) least = fmin(least, lanes[l]);
  return least;
}

// The single sums of the discrepancies, out[kind * blocks + block], one block of W points per item:
//   0 L2-star: prod (1 - x^2) (Warnock 1972)
//   1 centred: prod (1 + |x - 1/2| / 2 - |x - 1/2|^2 / 2) (Hickernell 1998, Math. Comp. 67)
//   2 mixture: prod (5/3 - |x - 1/2| / 4 - |x - 1/2|^2 / 4) (Zhou, Fang & Ning 2013, eq. (18))
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void single_sums(
    __global const scalar *restrict x, __global const scalar *restrict weight, uint padded, uint dim,
    __global scalar *restrict out) {
  const uint blocks = padded / KOKSMA_LANES_PER_ITEM, block = get_global_id(0);
  if (block >= blocks) return;
  const uint first = block * KOKSMA_LANES_PER_ITEM;
  real star = R(1.0), centred = R(1.0), mixture = R(1.0);
  for (uint j = 0; j < dim; ++j) {
    const real a = load_lanes(x + j * padded + first), c = fabs(a - R(0.5));
    star *= R(1.0) - a * a;
    centred *= R(1.0) + R(0.5) * c - R(0.5) * c * c;
    mixture *= R(1.6666666666666666667) - R(0.25) * c - R(0.25) * c * c;
  }
  const real w = load_lanes(weight + first);
  out[block] = lane_sum(w * star);
  out[blocks + block] = lane_sum(w * centred);
  out[2 * blocks + block] = lane_sum(w * mixture);
}

// The double sums, out[kind * rows + m]; B_2(t) = t^2 - t + 1/6:
//   0 L2-star: prod (1 - max(x, y))                                     Warnock 1972
//   1 centred: prod (1 + (|x - 1/2| + |y - 1/2| - |x - y|) / 2)         Hickernell 1998
//   2 wrap-around: prod (3/2 - |x - y| (1 - |x - y|))                   Hickernell 1998, Lecture Notes in Statistics 138
//   3 mixture: prod (15/8 - (|x - 1/2| + |y - 1/2|) / 4 - 3 |x - y| / 4 + |x - y|^2 / 2)   Zhou et al. 2013
//   4 diaphony: prod (1 + 2 pi^2 B_2(|x - y|))                          Zinterhof 1976
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void pair_sums(
    __global const scalar *restrict x, __global const scalar *restrict weight, uint padded, uint dim,
    uint rows, __global scalar *restrict out) {
  const uint m = get_global_id(0);
  if (m >= rows) return;
  const uint own = m / KOKSMA_LANES_PER_ITEM * KOKSMA_LANES_PER_ITEM;
  real sums[5] = {R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)};
  for (uint n = own; n < padded; n += KOKSMA_LANES_PER_ITEM) {
    real star = R(1.0), centred = R(1.0), wrap = R(1.0), mixture = R(1.0), diaphony = R(1.0);
    for (uint j = 0; j < dim; ++j) {
      const real a = (real)x[j * padded + m], b = load_lanes(x + j * padded + n);
      const real gap = fabs(a - b), centres = fabs(a - R(0.5)) + fabs(b - R(0.5));
      const real around = gap * (R(1.0) - gap);
      star *= R(1.0) - fmax(a, b);
      centred *= R(1.0) + R(0.5) * (centres - gap);
      wrap *= R(1.5) - around;
      mixture *= R(1.875) - R(0.25) * centres - R(0.75) * gap + R(0.5) * gap * gap;
      diaphony *= R(1.0) + R(19.739208802178717238) * (R(0.16666666666666666667) - around);
    }
    const real w = load_lanes(weight + n) * (real)(scalar)(n == own ? 1 : 2);
    sums[0] += w * star;
    sums[1] += w * centred;
    sums[2] += w * wrap;
    sums[3] += w * mixture;
    sums[4] += w * diaphony;
  }
  for (uint kind = 0; kind < 5; ++kind) out[kind * rows + m] = lane_sum(sums[kind]);
}

// out[m] = the least squared toroidal distance of point m to a point other than itself.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void nearest(
    __global const scalar *restrict x, __global const scalar *restrict weight, uint padded, uint dim,
    uint rows, __global scalar *restrict out) {
  const uint m = get_global_id(0);
  if (m >= rows) return;
  const uint own = m / KOKSMA_LANES_PER_ITEM * KOKSMA_LANES_PER_ITEM;
  const real lanes = KOKSMA_TO_REAL(lane_numbers());
  const real far = (real)(scalar)(dim + 1);  // no squared distance on the torus exceeds dim / 4
  real least = far;
  for (uint n = own; n < padded; n += KOKSMA_LANES_PER_ITEM) {
    real square = R(0.0);
    for (uint j = 0; j < dim; ++j) {
      const real gap = fabs((real)x[j * padded + m] - load_lanes(x + j * padded + n));
      const real t = fmin(gap, R(1.0) - gap);
      square = fma(t, t, square);
    }
    square = select_real(load_lanes(weight + n) < R(0.5), far, square);
    if (n == own) square = select_real(lanes == (real)(scalar)(m - own), far, square);
    least = fmin(least, square);
  }
  out[m] = lane_minimum(least);
}

// Toroidal distances of the pairs of a planar set, counted in bins of width 1 / scale[0]:
// out[item * bins + bin], the rows m = item, item + items, ... of one item.
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void pair_histogram(
    __global const scalar *restrict x, uint padded, uint rows, uint items, uint bins,
    __global const scalar *restrict scale, __global uint *restrict out) {
  const uint item = get_global_id(0);
  if (item >= items) return;
  __global uint *count = out + item * bins;
  for (uint b = 0; b < bins; ++b) count[b] = 0;
  const scalar reach = (scalar)bins / scale[0];
  for (uint m = item; m < rows; m += items) {
    const scalar x0 = x[m], y0 = x[padded + m];
    for (uint n = m + 1; n < rows; ++n) {
      const scalar gx = fabs(x0 - x[n]), gy = fabs(y0 - x[padded + n]);
      const scalar u = fmin(gx, 1 - gx), v = fmin(gy, 1 - gy);
      const scalar square = u * u + v * v;
      if (square >= reach * reach) continue;
      const uint bin = (uint)(sqrt(square) * scale[0]);
      if (bin < bins) ++count[bin];
    }
  }
}
