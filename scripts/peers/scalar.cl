// Quasi-Monte Carlo kernels as they are usually written, with scalar work-items. `point` takes one point a
// work-item: it forms its point of Sobol's sequence from its index, dimension by dimension, by XORing the
// columns of the Gray code's bits. `strided` takes every 2^log2_stride-th point, and goes on from one to the
// next by two XORs a dimension (T. Bradley, J. du Toit, R. Tong, M. Giles and P. Woodhams, Parallelization
// techniques for random number generators, GPU Computing Gems (2011), chapter 16). The work-group adds up in
// local memory. Built with REAL=float or double; sums are doubles, as koksma's.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

inline REAL value(__constant REAL *c, REAL phase, uint kind, const REAL *x) {
  REAL y = kind == 0 ? (REAL)1 : phase;
  for (uint j = 0; j < DIM; ++j) {
    if (kind == 0) y *= 1 + c[j] * (x[j] - (REAL)0.5);
    if (kind == 1) {
      const REAL t = c[2 * j] * (x[j] - c[2 * j + 1]);
      y += t * t;
    }
    if (kind == 2) y += c[j] * x[j];
  }
  return kind == 0 ? y : kind == 1 ? exp(-y) : cos(y);
}

void reduce(double y, __local double *scratch, __global double *partial) {
  const uint l = get_local_id(0);
  scratch[l] = y;
  for (uint half_size = get_local_size(0) / 2; half_size > 0; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l < half_size) scratch[l] += scratch[l + half_size];
  }
  if (l == 0) partial[get_group_id(0)] = scratch[0];
}

void first_point(uint index, __constant uint *columns, __constant uint *shifts, uint *bits) {
  const uint gray = index ^ (index >> 1);
  for (uint j = 0; j < DIM; ++j) {
    bits[j] = shifts[j];
    for (uint k = 0, g = gray; g != 0; ++k, g >>= 1)
      if (g & 1) bits[j] ^= columns[j * 32 + k];
  }
}

REAL value_at(const uint *bits, __constant REAL *c, REAL phase) {
  REAL x[DIM];
  for (uint j = 0; j < DIM; ++j) x[j] = bits[j] * (REAL)2.3283064365386963e-10;  // 2^-32
  return value(c, phase, KIND, x);
}

__kernel void point(uint count, uint log2_stride, __constant uint *columns, __constant uint *shifts,
                    __constant REAL *c, REAL phase, __local double *scratch, __global double *partial) {
  uint bits[DIM];
  first_point(get_global_id(0), columns, shifts, bits);
  reduce(value_at(bits, c, phase), scratch, partial);
}

// From index i to i + 2^s the Gray code changes in bit s - 1 and in bit s + (trailing ones of i >> s).
__kernel void strided(uint count, uint log2_stride, __constant uint *columns, __constant uint *shifts,
                      __constant REAL *c, REAL phase, __local double *scratch, __global double *partial) {
  uint bits[DIM];
  first_point(get_global_id(0), columns, shifts, bits);
  double sum = value_at(bits, c, phase);
  for (uint step = 1; step < count >> log2_stride; ++step) {
    const uint k = log2_stride + 31 - clz(step & -step);
    for (uint j = 0; j < DIM; ++j) bits[j] ^= columns[j * 32 + log2_stride - 1] ^ columns[j * 32 + k];
    sum += value_at(bits, c, phase);
  }
  reduce(sum, scratch, partial);
}

// Evaluates points x[point][dimension] that another kernel has written.
__kernel void evaluate(__global const REAL *points, __constant REAL *c, REAL phase, __local double *scratch,
                       __global double *partial) {
  const size_t index = get_global_id(0);
  REAL x[DIM];
  for (uint j = 0; j < DIM; ++j) x[j] = points[index * DIM + j];
  reduce(value(c, phase, KIND, x), scratch, partial);
}
