// net.cl: are the elementary intervals of one shape full? For N = 2^m points and a shape (k_1, ..., k_d) with
// sum k, the cells have sides 2^-k_j, and 2^(m-k) points each make it balanced (Niederreiter 1992, definition
// 4.1).
//   digits[dimension * n + point] = floor(x 2^m); shapes[shape * dim + dimension] = k_j
//   counts: 2^k per shape of this launch; out[shape] = 1 if balanced, else 0
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void balanced_shapes(
    __global const uint *restrict digits, uint n, uint dim, uint m, uint k,
    __global const uchar *restrict shapes, uint count, __global uint *restrict counts,
    __global uint *restrict out) {
  const uint shape = get_global_id(0);
  if (shape >= count) return;
  __global uint *cells = counts + ((ulong)shape << k);
  for (uint c = 0; c >> k == 0; ++c) cells[c] = 0;
  const uint most = 1u << (m - k);
  // 2^k cells share n points: all hold `most` unless one holds more.
  uint balanced = 1;
  for (uint i = 0; i < n && balanced; ++i) {
    uint cell = 0;
    for (uint j = 0; j < dim; ++j) {
      const uint bits = shapes[shape * dim + j];
      if (bits != 0) cell = cell << bits | digits[j * n + i] >> (m - bits);
    }
    balanced = ++cells[cell] <= most;
  }
  out[shape] = balanced;
}
