// count.cl: the loop of integrate.cl, run by one work-item over `steps` vectors of samples, for the sake of the counts
// beside its statements. Those of seeking are kept apart: they come once per block.
// As integrate.cl adds; of the squares those of values.
static inline void add_sample(sum *s, sum *squares, real y, sum_scalar centre) {
  sum_value v = sum_convert(y);
  sum_add(s, v);
#if KOKSMA_MOMENTS == 2
  v = v - centre;
  sum_add(squares, v * v);
#endif
}

__kernel void count_operations(__global const word *restrict table, __global const scalar *restrict values,
                               coefficients c, ulong n, ulong seed, uint steps, __global ulong *restrict out) {
  koksma_counted counts;
  koksma_counted *koksma_counting = &counts;
  for (uint i = 0; i < KOKSMA_COUNTED_SLOTS * KOKSMA_COUNTED_OPERATIONS; ++i) counts.at[i] = 0;
  const params q = load_params(values);
  points p;
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_SEEK);
  points_seek(&p, table, 0, n, seed, 0, 0);
  sum s, squares;
  sum_init(&s);
  sum_init(&squares);
  for (uint j = 0; j < steps; ++j) {
    KOKSMA_COUNT_AS(KOKSMA_COUNTED_INTEGRAND);
    const real y = integrand(&p, q, c);
    KOKSMA_COUNT_AS(KOKSMA_COUNTED_SUM);
    add_sample(&s, &squares, y, 0);
    KOKSMA_COUNT_AS(KOKSMA_COUNTED_POINTS);
    points_step(&p);
  }
  for (uint i = 0; i < KOKSMA_COUNTED_SLOTS * KOKSMA_COUNTED_OPERATIONS; ++i) out[i] = counts.at[i];
}
