// spectrum.cl: the periodogram of a planar set at integer frequencies, P(k) = |sum_n exp(-2 pi i k.x_n)|^2 / N
// (Ulichney 1987, Digital Halftoning; Lagae & Dutre 2008, Comput. Graph. Forum 27). P(-k) = P(k), so only
// kx >= 0 is computed. A work-item takes one kx and steps through ky = -reach ... in blocks of W lanes:
// exp(-2 pi i (kx x + ky y)) is a scalar factor of the block, which is multiplied by exp(-2 pi i W y) from
// block to block, times a vector of the lanes; so sine and cosine are evaluated once per point and kx, not per
// frequency. At most 1025 / W factors follow each other: an error of as many units in the last place.
//   sums[(2 kx + part) * row + column], column = ky + reach, row = blocks * W >= 2 reach + 1; out[kx * row + column]
static inline void unit_turn(real turns, real *re, real *im) {
  *re = cospi(R(2.0) * turns);
  *im = sinpi(R(2.0) * turns);
}

__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void power_spectrum(
    __global const scalar *restrict x, uint padded, uint n, uint reach, uint blocks,
    __global scalar *restrict sums, __global scalar *restrict out) {
  const uint kx = get_global_id(0), row = blocks * KOKSMA_LANES_PER_ITEM;
  if (kx > reach) return;
  __global scalar *re = sums + (ulong)2 * kx * row, *im = re + row;
  for (uint c = 0; c < 2 * row; ++c) re[c] = 0;

  for (uint i = 0; i < n; ++i) {
    const scalar y = x[padded + i];
    const scalar first = (scalar)kx * x[i] - (scalar)reach * y, step = (scalar)KOKSMA_LANES_PER_ITEM * y;
    real lane_re, lane_im;
    unit_turn(KOKSMA_TO_REAL(lane_numbers()) * (real)y, &lane_re, &lane_im);
    scalar u = cospi(2 * first), v = sinpi(2 * first);
    const scalar step_u = cospi(2 * step), step_v = sinpi(2 * step);
    for (uint c = 0; c < row; c += KOKSMA_LANES_PER_ITEM) {
      store_lanes(load_lanes(re + c) + ((real)u * lane_re - (real)v * lane_im), re + c);
      store_lanes(load_lanes(im + c) + ((real)u * lane_im + (real)v * lane_re), im + c);
      const scalar turned = u * step_u - v * step_v;
      v = u * step_v + v * step_u;
      u = turned;
    }
  }
  for (uint c = 0; c < row; ++c) out[(ulong)kx * row + c] = (re[c] * re[c] + im[c] * im[c]) / (scalar)n;
}
