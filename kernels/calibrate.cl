// calibrate: a fixed amount of arithmetic, whose time says how fast the device is just now. `koksma compare`
// divides times by it. Like the integration kernels it steps integer states, makes coordinates of them and
// multiplies and adds, in four independent chains so that throughput counts and not latency, and touches no memory.
// Changing it changes what results of different versions are divided by.
//   out[item] = a value that needs all steps
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void calibrate(
    uint salt, __global scalar *restrict out) {
  const uint steps = 1000;  // about 20 us of one core at 3 GHz with 16 lanes
  bits state[4];
  real total[4];
  _Pragma("unroll") for (uint k = 0; k < 4; ++k) {
    state[k] = (bits)KOKSMA_LANE_NUMBERS + (word)(salt + 16 * (4 * (uint)get_global_id(0) + k));
    total[k] = R(0.0);
  }
  for (uint i = 0; i < steps; ++i) {
    _Pragma("unroll") for (uint k = 0; k < 4; ++k) {
      // The generator of Numerical Recipes (2nd ed., section 7.1), of which any bits will do.
      state[k] = state[k] * (word)1664525U + (word)1013904223U;
      state[k] ^= state[k] >> (word)15;
      const real x = unit_from_word(state[k]);
      total[k] = fma(total[k], R(0.5), x * (R(1.0) - x));
    }
  }
  real sum = total[0] + total[1] + (total[2] + total[3]);
#if KOKSMA_LANES_PER_ITEM == 1
  out[get_global_id(0)] = sum;
#else
  out[get_global_id(0)] = sum.s0 + sum.s1 + sum.s2 + sum.s3;
#endif
}
