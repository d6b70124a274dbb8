// general/integrate.cl: the integration kernel as one would write it once for all estimators, for comparison with
// integrate.cl: sums y and a square whatever the estimator asks for, what is squared and whether samples that are not
// finite are counted are found at run time. Blocks, lanes and the order of additions are those of integrate.cl, and so
// are the arguments; `out` holds the words of sum y, those of the squares, and one word with the count.
#if KOKSMA_LANES_PER_ITEM == 1
static inline mask lanes_below(uint lane, uint count) { return lane < count; }
#define KOKSMA_OTHER_OF_PAIR(v) (v)  // pairs are planned with vectors only
#else
static inline mask lanes_below(uint lane, uint count) {
  return KOKSMA_PASTE(KOKSMA_PASTE(convert_, KOKSMA_SIGNED), KOKSMA_LANES_PER_ITEM)(lane_numbers() + lane < (words32)count);
}
#if KOKSMA_LANES_PER_ITEM == 4
#define KOKSMA_OTHER_OF_PAIR(v) (v).s1032
#elif KOKSMA_LANES_PER_ITEM == 8
#define KOKSMA_OTHER_OF_PAIR(v) (v).s10325476
#else
#define KOKSMA_OTHER_OF_PAIR(v) (v).s1032547698badcfe
#endif
#endif

// As KOKSMA_SQUARES_OF of integrate.cl.
static inline sum_value squared_term(sum_value v, sum_scalar centre, uint squares_of) {
  if (squares_of == 0) return v - centre;
  if (squares_of == 1) return (v + KOKSMA_OTHER_OF_PAIR(v)) / 2 - centre;
  return v - KOKSMA_OTHER_OF_PAIR(v);
}

__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void integrate(
    __global const word *restrict switches, __global const scalar *restrict values, coefficients c, ulong first_block,
    ulong blocks, ulong n, ulong seed, uint log2_block, uint first_replicate, sum_scalar centre,
    __global sum_scalar *restrict out) {
  const uint groups = KOKSMA_LANES / KOKSMA_LANES_PER_ITEM;
  const ulong item = get_global_id(0);
  const ulong block = item / groups;
  const uint lane = (uint)(item % groups) * KOKSMA_LANES_PER_ITEM;
  const uint replicate = get_global_id(1);
  if (block >= blocks) return;

  const params q = load_params(values);
  const uint squares_of = (uint)switches[KOKSMA_GENERAL_SQUARES_OF];
  const uint counts = (uint)switches[KOKSMA_GENERAL_COUNTS];
  const ulong first = (first_block + block) << log2_block;
  const ulong in_block = min(n - first, (ulong)1 << log2_block);
  const uint steps = (uint)((in_block + KOKSMA_LANES - 1) / KOKSMA_LANES);

  points p;
  points_seek(&p, switches, first, n, seed, first_replicate + replicate, lane);
  sum s, squares;
  sum_init(&s);
  sum_init(&squares);
  uint nonfinite = 0;
  real y;
  sum_value v;
  for (uint j = 1;; ++j) {
    y = integrand(&p, q, c);
    if (j == steps) break;
    if (counts) nonfinite += count_lanes(nonfinite_lanes(y));
    v = sum_convert(y);
    sum_add(&s, v);
    v = squared_term(v, centre, squares_of);
    sum_add(&squares, v * v);
    points_step(&p);
  }
  // The last sample is added outside the loop: only there can lanes lie beyond n.
  const mask valid = lanes_below(lane, (uint)(in_block - (ulong)(steps - 1) * KOKSMA_LANES));
  y = select_real(valid, y, R(0.0));
  if (counts) nonfinite += count_lanes(nonfinite_lanes(y));
  sum_add(&s, sum_convert(y));
  v = squared_term(sum_convert(y), centre, squares_of);
  v *= sum_convert(select_real(valid, (real)R(1.0), (real)R(0.0)));
  sum_add(&squares, v * v);

  const ulong stride = blocks * KOKSMA_LANES * get_global_size(1);
  out += (replicate * blocks + block) * KOKSMA_LANES + lane;
  sum_store(&s, out, stride);
  sum_store(&squares, out + KOKSMA_SUM_WORDS * stride, stride);
  out[2 * KOKSMA_SUM_WORDS * stride] = nonfinite;
}
