// calibrate: a fixed amount of arithmetic, whose time says how fast the device is just now. `koksma compare`
// divides times by it. Like the integration kernels it steps integer states, makes coordinates of them and
// multiplies and adds, and touches no memory. It steps one chain, two on AVX2 as a vector has two halves there, so that it feels
// a core that is shared with another thread about as much as integration kernels do: by 1.4, where kernels of nets,
// lattices and Philox slow down by 1.2 to 1.5 and four chains by 1.6.
// Changing it changes what results of different versions are divided by.
//   out[item] = a value that needs all steps
__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void calibrate(
    uint salt, __global scalar *restrict out) {
  const uint steps = 14000;  // about 45 us of one core at 3 GHz with 16 lanes
  bits state = (bits)KOKSMA_LANE_NUMBERS + (word)(salt + 16 * (uint)get_global_id(0));
  real total = R(0.0);
  for (uint i = 0; i < steps; ++i) {
    // The generator of Numerical Recipes (2nd ed., section 7.1), of which any bits will do.
    state = state * (word)1664525U + (word)1013904223U;
    state ^= state >> (word)15;
    const real x = unit_from_word(state);
    total = fma(total, R(0.5), x * (R(1.0) - x));
  }
#if KOKSMA_LANES_PER_ITEM == 1
  out[get_global_id(0)] = total;
#else
  out[get_global_id(0)] = total.s0 + total.s1 + total.s2 + total.s3;
#endif
}
