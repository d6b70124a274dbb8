// calibrate: a fixed amount of arithmetic, whose time says how fast the device is just now. `koksma compare`
// divides times by it. Like the integration kernels it steps integer states, makes coordinates of them and
// multiplies and adds, and touches no memory. It is to feel a core that is shared with another thread as much as integration
// kernels do. On AVX2 one chain does, of two halves: 1.4 times as long, where kernels of nets, lattices and Philox take 1.2
// to 1.5 and four chains 1.6. On AVX-512 (a Xeon) one or two chains wait for their results, 1.1 where kernels take 1.8.
// Changing it changes what results of different versions are divided by.
//   out[item] = a value that needs all steps
#ifdef __AVX512F__
#define KOKSMA_CHAINS 4
#define KOKSMA_STEPS 8000
#else
#define KOKSMA_CHAINS 1
#define KOKSMA_STEPS 14000  // about 45 us of one core at 3 GHz with 16 lanes
#endif

__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void calibrate(
    uint salt, __global scalar *restrict out) {
  bits state[KOKSMA_CHAINS];
  real sum[KOKSMA_CHAINS];
  _Pragma("unroll")
  for (uint k = 0; k < KOKSMA_CHAINS; ++k) {
    state[k] = (bits)KOKSMA_LANE_NUMBERS + (word)(salt + 16 * (uint)get_global_id(0) + 77777 * k);
    sum[k] = R(0.0);
  }
  for (uint i = 0; i < KOKSMA_STEPS; ++i) {
    _Pragma("unroll")
    for (uint k = 0; k < KOKSMA_CHAINS; ++k) {
      // The generator of Numerical Recipes (2nd ed., section 7.1), of which any bits will do.
      state[k] = state[k] * (word)1664525U + (word)1013904223U;
      state[k] ^= state[k] >> (word)15;
      const real x = unit_from_word(state[k]);
      sum[k] = fma(sum[k], R(0.5), x * (R(1.0) - x));
    }
  }
  real total = sum[0];
  _Pragma("unroll")
  for (uint k = 1; k < KOKSMA_CHAINS; ++k) total += sum[k];
#if KOKSMA_LANES_PER_ITEM == 1
  out[get_global_id(0)] = total;
#else
  out[get_global_id(0)] = total.s0 + total.s1 + total.s2 + total.s3;
#endif
}
