// integrate.cl: the one integration kernel, seek -> draw -> evaluate -> accumulate -> store.
// A work-item sums one lane group (W of the 16 lanes) of one block of 2^log2_block samples in a fixed order,
// so the partial sums are the same bits for every vector width, work-group size and launch split.
//   global size: (blocks of this launch * 16 / W, padded to the local size; replicates of this launch; runs)
//   out[(((run * words + word) * replicates + replicate) * blocks + block) * 16 + lane], the words of sum y first,
//   then (KOKSMA_MOMENTS == 2) those of the squares of squared_term. Runs are all the same: timed together, what a launch
//   costs is shared out.
// KOKSMA_COUNTERS: a single run, whose samples are counted too (counters.cl); the sums stay the same bits.
//   counts, sizes[((word * replicates + replicate) * blocks + block) * 16 / W + group]
#if KOKSMA_LANES_PER_ITEM == 1
static inline mask lanes_below(uint lane, uint count) { return lane < count; }
#else
static inline mask lanes_below(uint lane, uint count) {
  return KOKSMA_PASTE(KOKSMA_PASTE(convert_, KOKSMA_SIGNED), KOKSMA_LANES_PER_ITEM)(lane_numbers() + lane < (words32)count);
}
#endif

#if KOKSMA_MOMENTS == 2
// What is squared: KOKSMA_SQUARES_OF 0: y - centre; 1: (y + y') / 2 - centre; 2: y - y', y' the other sample of the pair
// 2i, 2i + 1, which the neighbouring lane holds. The sums over lanes hold every pair twice.
#if KOKSMA_LANES_PER_ITEM == 4
#define KOKSMA_OTHER_OF_PAIR(v) (v).s1032
#elif KOKSMA_LANES_PER_ITEM == 8
#define KOKSMA_OTHER_OF_PAIR(v) (v).s10325476
#elif KOKSMA_LANES_PER_ITEM == 16
#define KOKSMA_OTHER_OF_PAIR(v) (v).s1032547698badcfe
#elif KOKSMA_SQUARES_OF > 0
#error "pairs need both lanes in one item"
#endif
static inline sum_value squared_term(sum_value v, sum_scalar centre) {
#if KOKSMA_SQUARES_OF == 0
  return v - centre;
#elif KOKSMA_SQUARES_OF == 1
  return (v + KOKSMA_OTHER_OF_PAIR(v)) / 2 - centre;
#else
  return v - KOKSMA_OTHER_OF_PAIR(v);
#endif
}
#endif

__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void integrate(
    __global const word *restrict table, __global const scalar *restrict values, coefficients c,
    ulong first_block, ulong blocks, ulong n, ulong seed, uint log2_block, uint first_replicate,
    sum_scalar centre, __global sum_scalar *restrict out
#if KOKSMA_COUNTERS
    , scalar blow_up, wide_scalar scale, __global ulong *restrict counts, __global wide_scalar *restrict sizes
#endif
) {
  const uint groups = KOKSMA_LANES / KOKSMA_LANES_PER_ITEM;
  const ulong item = get_global_id(0);
  const ulong block = item / groups;
  const uint lane = (uint)(item % groups) * KOKSMA_LANES_PER_ITEM;
  const uint replicate = get_global_id(1);
  if (block >= blocks) return;

  const params q = load_params(values);
  const ulong first = (first_block + block) << log2_block;
  const ulong in_block = min(n - first, (ulong)1 << log2_block);
  const uint steps = (uint)((in_block + KOKSMA_LANES - 1) / KOKSMA_LANES);

  points p;
  points_seek(&p, table, first, n, seed, first_replicate + replicate, lane);
  sum s;
  sum_init(&s);
#if KOKSMA_MOMENTS == 2
  sum squares;
  sum_init(&squares);
#endif
#if KOKSMA_COUNTERS
  counters k;
  counters_init(&k);
  const mask every = lanes_below(0, KOKSMA_LANES);
  const word limit = KOKSMA_PASTE(as_, KOKSMA_WORD)(blow_up);
#endif
  // The last sample leaves the loop before it is added: only there can lanes lie beyond n.
  real y;
  sum_value v;
  for (uint j = 1;; ++j) {
    y = integrand(&p, q, c);
    if (j == steps) break;
    v = sum_convert(y);
    sum_add(&s, v);
#if KOKSMA_MOMENTS == 2
    v = squared_term(v, centre);
    sum_add(&squares, v * v);
#endif
#if KOKSMA_COUNTERS
    count_samples(&k, y, &p, every, limit, scale);
#endif
    points_step(&p);
  }
  const uint last = (uint)(in_block - (ulong)(steps - 1) * KOKSMA_LANES);
  const mask valid = lanes_below(lane, last);
  y = select_real(valid, y, R(0.0));
  sum_add(&s, sum_convert(y));
#if KOKSMA_COUNTERS
  count_samples(&k, y, &p, valid, limit, scale);
#endif

  const ulong stride = blocks * KOKSMA_LANES * get_global_size(1);
  out += get_global_id(2) * (KOKSMA_MOMENTS * KOKSMA_SUM_WORDS) * stride;
  out += (replicate * blocks + block) * KOKSMA_LANES + lane;
  sum_store(&s, out, stride);
#if KOKSMA_MOMENTS == 2
  v = squared_term(sum_convert(y), centre);
  // A lane beyond n holds y = 0 here; its square about the centre must not count.
  v *= sum_convert(select_real(valid, (real)R(1.0), (real)R(0.0)));
  sum_add(&squares, v * v);
  sum_store(&squares, out + KOKSMA_SUM_WORDS * stride, stride);
#endif
#if KOKSMA_COUNTERS
  const ulong place = (replicate * blocks + block) * groups + lane / KOKSMA_LANES_PER_ITEM;
  counters_store(&k, (ulong)steps * KOKSMA_LANES_PER_ITEM, counts + place, sizes + place,
                 blocks * groups * get_global_size(1));
#endif
}
