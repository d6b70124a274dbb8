// inspect.cl: the points themselves, for `koksma points` and the tests.
//   dump_points: out[((block * steps + step) * KOKSMA_DIM + dimension) * 16 + lane], steps = 2^log2_block / 16
//   dump_draws (only with an integrand): out[2 * lane group], out[2 * lane group + 1] = the fewest and the most coordinates
//   that one of its samples draws, `steps` of every lane
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void dump_points(
    __global const word *restrict table, ulong first_block, ulong blocks, ulong n, ulong seed,
    uint log2_block, uint replicate, __global scalar *restrict out) {
  const uint groups = KOKSMA_LANES / KOKSMA_LANES_PER_ITEM;
  const ulong block = get_global_id(0) / groups;
  const uint lane = (uint)(get_global_id(0) % groups) * KOKSMA_LANES_PER_ITEM;
  if (block >= blocks) return;

  points p;
  points_seek(&p, table, (first_block + block) << log2_block, n, seed, replicate, lane);
  const uint steps = 1u << (log2_block - 4);
  __global scalar *row = out + block * steps * KOKSMA_DIM * KOKSMA_LANES + lane;
  for (uint j = 1;; ++j) {
    for (uint d = 0; d < KOKSMA_DIM; ++d, row += KOKSMA_LANES) store_lanes(points_next(&p), row);
    if (j == steps) break;
    points_step(&p);
  }
}

#if KOKSMA_WITH_INTEGRAND
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void dump_draws(
    __global const word *restrict table, __global const scalar *restrict values, coefficients c,
    ulong n, ulong seed, uint steps, __global uint *restrict out) {
  const uint groups = KOKSMA_LANES / KOKSMA_LANES_PER_ITEM;
  const uint group = get_global_id(0);
  if (group >= groups) return;
  points p;
  points_seek(&p, table, 0, n, seed, 0, group * KOKSMA_LANES_PER_ITEM);
  const params q = load_params(values);
  uint fewest = UINT_MAX, most = 0;
  for (uint j = 0; j < steps; ++j, points_step(&p)) {
    integrand(&p, q, c);
    fewest = min(fewest, points_drawn(&p));
    most = max(most, points_drawn(&p));
  }
  out[2 * group] = fewest;
  out[2 * group + 1] = most;
}
#endif
