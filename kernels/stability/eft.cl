// eft: error-free transformations of numbers that come as arguments, so that no compiler can fold them.
// TwoSum: D. E. Knuth, The Art of Computer Programming 2 (1969), section 4.2.2, theorem B; TwoProd: T. J. Dekker,
// Numer. Math. 18 (1971), with Veltkamp's splitting.
#pragma OPENCL FP_CONTRACT OFF
// out: a + b rounded, its error
__kernel void two_sum(scalar a, scalar b, __global scalar *out) {
  const scalar s = a + b;
  const scalar of_b = s - a;
  out[0] = s;
  out[1] = (a - (s - of_b)) + (b - of_b);
}

// out: a b rounded, its error; `splitter` is 2^ceil(p/2) + 1 for p bits of mantissa
__kernel void two_prod(scalar a, scalar b, scalar splitter, __global scalar *out) {
  const scalar p = a * b;
  const scalar at = splitter * a, bt = splitter * b;
  const scalar a_high = at - (at - a), b_high = bt - (bt - b);
  const scalar a_low = a - a_high, b_low = b - b_high;
  out[0] = p;
  out[1] = a_low * b_low - (((p - a_high * b_high) - a_low * b_high) - a_high * b_low);
}

// out: a b - c in one expression. Contracted to a fused operation it keeps what FP_CONTRACT OFF rounds away.
__kernel void uncontracted(scalar a, scalar b, scalar c, __global scalar *out) { out[0] = a * b - c; }
#pragma OPENCL FP_CONTRACT ON
