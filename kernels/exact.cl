// exact.cl: the program of exact values, the last piece after the params and the integrand's KOKSMA_EXACT
// part. It runs in scalar double on a CPU device with fp64, once per cell, and is built without any
// relaxed flag. Defines: KOKSMA_EXACT_MEAN, _VARIANCE, _MEAN_ABS, _VARIATION, _DISCRETE, _BOUND, _STIFFNESS (1 where the integrand has that
// function), KOKSMA_EXACT_ORDER (1 where it has dimension_order) and KOKSMA_EXACT_SETUP (the number of coefficients,
// where there are any). `values` are the parameters in their order.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

// Gauss-Legendre nodes and weights of 16 points on (-1,1), positive half (Abramowitz & Stegun, table 25.4).
__constant double koksma_legendre_nodes[8] = {
    0.0950125098376374401853, 0.28160355077925891323, 0.458016777657227386342, 0.617876244402643748447,
    0.755404408355003033895, 0.86563120238783174388, 0.944575023073232576078, 0.989400934991649932596};
__constant double koksma_legendre_weights[8] = {
    0.189450610455068496285, 0.182603415044923588867, 0.169156519395002538189, 0.149595988816576732082,
    0.124628971255533872052, 0.0951585116824927848099, 0.0622535239386478928628, 0.0271524594117540948518};

// Point k = 0 ... 15 of the rule on [0, length]. An integrand that wants it declares it, as this piece
// comes last.
static void legendre_16(uint k, double length, double *y, double *weight) {
  const double node = koksma_legendre_nodes[k % 8];
  *y = length / 2 * (k < 8 ? 1 - node : 1 + node);
  *weight = length / 2 * koksma_legendre_weights[k % 8];
}

// One dimension more for the Hardy-Krause variation, anchored at 1, of a product of functions g_j: it is
// prod (|g_j(1)| + Var g_j) - prod |g_j(1)| (the sum over faces of products of variations, Owen 2005, Multidimensional
// variation for quasi-Monte Carlo). *variation starts at 0 and *at_one, the product of the
// |g_j(1)|, at 1; built up without a subtraction. An integrand that wants it declares it.
static void add_variation_factor(double value_at_one, double total_variation, double *variation, double *at_one) {
  *variation = (fabs(value_at_one) + total_variation) * *variation + total_variation * *at_one;
  *at_one *= fabs(value_at_one);
}

// out = mean, variance, mean of |f|, Hardy-Krause variation; mean, variance and mean of |f| of the numerical solution;
// sup |f| of the true one; the largest h |lambda|. NaN where the integrand's entry has no formula.
__kernel void exact_values(__global const double *values, uint d, __global double *out) {
  const params q = load_params(values);
  for (uint i = 0; i < 9; ++i) out[i] = NAN;
#ifdef KOKSMA_EXACT_MEAN
  out[0] = exact_mean(q, d);
#endif
#ifdef KOKSMA_EXACT_VARIANCE
  out[1] = exact_variance(q, d);
#endif
#ifdef KOKSMA_EXACT_MEAN_ABS
  out[2] = exact_mean_abs(q, d);
#endif
#ifdef KOKSMA_EXACT_VARIATION
  out[3] = exact_variation(q, d);
#endif
#ifdef KOKSMA_EXACT_DISCRETE
  double mean, variance, mean_abs;
  discrete_moments(q, d, &mean, &variance, &mean_abs);
  out[4] = mean;
  out[5] = variance;
  out[6] = mean_abs;
#endif
#ifdef KOKSMA_EXACT_BOUND
  out[7] = exact_bound(q, d);
#endif
#ifdef KOKSMA_EXACT_STIFFNESS
  out[8] = exact_stiffness(q, d);
#endif
}

#ifdef KOKSMA_EXACT_ORDER
// out[k] = the dimension of the points that draw k takes; the global size is d.
__kernel void order_dimensions(__global const double *values, uint d, __global uint *out) {
  const uint k = get_global_id(0);
  if (k < d) out[k] = dimension_order(load_params(values), d, k);
}
#endif

#ifdef KOKSMA_EXACT_SETUP
// out[j * K + k] = coefficient k of dimension j = 0 ... d-1; the global size is d.
__kernel void setup_coefficients(__global const double *values, uint d, __global double *out) {
  const uint j = get_global_id(0);
  if (j >= d) return;
  double c[KOKSMA_EXACT_SETUP];
  integrand_setup(load_params(values), d, j, c);
  for (uint k = 0; k < KOKSMA_EXACT_SETUP; ++k) out[(ulong)j * KOKSMA_EXACT_SETUP + k] = c[k];
}
#endif
