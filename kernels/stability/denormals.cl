// denormals: what becomes of numbers below the normal range; bits in and out, so that nothing on the way flushes them.
//   out: the bits of a b, of x + 0 and of x * 1; whether x > 0; x != 0
__kernel void denormals(scalar a, scalar b, scalar zero, scalar one, __global const scalar *x, __global word *out) {
  out[0] = KOKSMA_PASTE(as_, KOKSMA_WORD)(a * b);
  out[1] = KOKSMA_PASTE(as_, KOKSMA_WORD)(x[0] + zero);
  out[2] = KOKSMA_PASTE(as_, KOKSMA_WORD)(x[0] * one);
  out[3] = x[0] > zero;
  out[4] = x[0] != zero;
}
