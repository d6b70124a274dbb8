// add-up: one sum piece, as it is, over terms in memory: term i is terms[i % count]. Included once per sum, with the
// names of its slots made its own; every lane adds the same terms.
//   out[word * KOKSMA_LANES_PER_ITEM + lane]
__kernel void add_up(__global const scalar *terms, uint count, uint n, __global sum_scalar *out) {
  sum s;
  sum_init(&s);
  uint k = 0;
  for (uint i = 0; i < n; ++i) {
    sum_add(&s, sum_convert((real)terms[k]));
    if (++k == count) k = 0;
  }
  sum_store(&s, out, KOKSMA_LANES_PER_ITEM);
}
