// calibrate: a fixed amount of work, whose time says how fast the device is just now. `koksma compare` takes out of times
// what follows it. It is to feel a core that is shared with another thread as integration kernels do, so it does what they
// mostly do: steps the states of a net in Gray-code order, loads, makes coordinates and multiplies. Beside somebody else's
// thread (Xeon, AVX-512) studies follow 0.88 of its change in logarithms; a loop that waits for its own results takes 1.1
// times as long and says nothing of kernels (results/README.md).
// Changing it changes what results of different versions are compared beside.
//   out[item] = a value that needs all steps
#define KOKSMA_CALIBRATION_DIM 8
#ifdef __AVX512F__
#define KOKSMA_CALIBRATION_STEPS 4500  // about 45 us of one core at 3 GHz with 16 lanes
#else
#define KOKSMA_CALIBRATION_STEPS 3000
#endif

__kernel __attribute__((reqd_work_group_size(KOKSMA_LOCAL_SIZE, 1, 1))) void calibrate(
    uint salt, __global scalar *restrict out) {
  uint columns[16 * KOKSMA_CALIBRATION_DIM];  // any bits will do
  for (uint k = 0; k < 16 * KOKSMA_CALIBRATION_DIM; ++k)
    columns[k] = (salt + (uint)get_global_id(0) + k) * 2654435761U;
  bits state[KOKSMA_CALIBRATION_DIM];
  for (uint k = 0; k < KOKSMA_CALIBRATION_DIM; ++k)
    state[k] = (bits)KOKSMA_LANE_NUMBERS * (word)134775813U + (word)(salt + k);
  real sum = R(0.0);
  for (uint i = 1; i <= KOKSMA_CALIBRATION_STEPS; ++i) {
    const uint column = KOKSMA_CALIBRATION_DIM * popcount((i & -i) - 1);
    real product = R(1.0);
    _Pragma("unroll")
    for (uint k = 0; k < KOKSMA_CALIBRATION_DIM; ++k) {
      state[k] ^= (word)columns[column + k];
      product *= fma(unit_from_word(state[k]), R(0.5), R(0.75));
    }
    sum += product;
  }
#if KOKSMA_LANES_PER_ITEM == 1
  out[get_global_id(0)] = sum;
#else
  out[get_global_id(0)] = sum.s0 + sum.s1 + sum.s2 + sum.s3;
#endif
}
