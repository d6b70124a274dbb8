// switches.cl: what the general kernels read at run time and the planned ones know when they are built. Comes before
// general/<family>.cl; the switches are the first KOKSMA_GENERAL_TABLE words of the table (kernels/README.md, "General
// kernels").
// What a float in [1,2) is less than to be a coordinate: centred in (0,1), or exact in [0,1) (prelude.cl).
static inline real general_origin(__global const word *switches) {
  if (switches[KOKSMA_GENERAL_CENTRED] == 0) return R(1.0);
#if KOKSMA_FP64
  return R(0x1.fffffffffffffp-1);
#else
  return R(0x1.fffffep-1);
#endif
}

// The top mantissa bits of a full-width fraction word as a coordinate.
static inline real general_unit(bits w, real origin) {
  const uint shift = 8 * sizeof(word) - KOKSMA_MANTISSA_BITS;
  return KOKSMA_AS_REAL(w >> (word)shift | (word)KOKSMA_ONE_PATTERN) - origin;
}
