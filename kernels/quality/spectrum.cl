// spectrum.cl: the periodogram of a planar set at integer frequencies, P(k) = |sum_n exp(-2 pi i k.x_n)|^2 / N
// (Ulichney 1987, Digital Halftoning; Lagae & Dutre 2008,
// Comput. Graph. Forum 27). P(-k) = P(k), so only
// kx >= 0 is computed.
//   out[kx * row + column], column = ky + reach, W columns per item; row = blocks * W >= 2 reach + 1
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void power_spectrum(
    __global const scalar *restrict x, uint padded, uint n, uint reach, uint blocks,
    __global scalar *restrict out) {
  const uint item = get_global_id(0);
  if (item >= (reach + 1) * blocks) return;
  const uint kx = item / blocks, first = item % blocks * KOKSMA_LANES_PER_ITEM;
  const real ky = KOKSMA_TO_REAL(lane_numbers()) + (real)((scalar)first - (scalar)reach);
  real re = R(0.0), im = R(0.0);
  for (uint i = 0; i < n; ++i) {
    // Phases in half turns; sinpi and cospi reduce them exactly.
    const real phase = R(2.0) * fma(ky, (real)x[padded + i], (real)((scalar)kx * x[i]));
    re += cospi(phase);
    im += sinpi(phase);
  }
  store_lanes((re * re + im * im) * (real)((scalar)1 / (scalar)n),
              out + (ulong)kx * blocks * KOKSMA_LANES_PER_ITEM + first);
}
