// radial-sing: |x|_2^-a, singular at the origin alone: of order a in d dimensions. Mean for a < d,
// variance for a < d/2. The origin gives infinity.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// x = s (1, u) and its permutations (Duffy, SIAM J. Numer. Anal. 19 (1982)): f = A B, A = s^-a with s of density
// d s^(d-1) and B = (1 + |u|^2)^(-a/2), u uniform on d - 1 coordinates, independent of s. B is analytic around the
// cube (poles at distance 1): 16 points per dimension. Mean of B - 1, or the mean square
// of B - 1 about `centre`.
static double mean_angular(params q, uint d, double centre, bool squared) {
  double node[16], weight[16];
  for (uint k = 0; k < 16; ++k) legendre_16(k, 1, &node[k], &weight[k]);
  double sum = 0;
  for (uint outer = 0; outer < 1u << 4 * (d - 2); ++outer) {
    double square = 0, outer_weight = 1, row = 0;
    for (uint j = 0; j + 2 < d; ++j) {
      const uint k = outer >> 4 * j & 15;
      square += node[k] * node[k];
      outer_weight *= weight[k];
    }
    for (uint k = 0; k < 16; ++k) {
      const double b = expm1(-q.a / 2 * log1p(square + node[k] * node[k]));
      row += weight[k] * (squared ? (b - centre) * (b - centre) : b);
    }
    sum += outer_weight * row;
  }
  return sum;
}

static double exact_mean(params q, uint d) {
  return q.a < d ? d / (d - q.a) * (1 + mean_angular(q, d, 0, false)) : INFINITY;
}

// Var AB = Var A Var B + Var A (E B)^2 + (E A)^2 Var B, all positive.
static double exact_variance(params q, uint d) {
  const double a = q.a;
  if (2 * a >= d) return INFINITY;
  const double radial = d / (d - a), angular = mean_angular(q, d, 0, false);
  const double spread = mean_angular(q, d, angular, true);
  const double radial_variance = d * a * a / ((d - 2 * a) * (d - a) * (d - a));
  return radial_variance * (spread + (1 + angular) * (1 + angular)) + radial * radial * spread;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    sum = fma(x, x, sum);
  }
  return pow(sum, R(-0.5) * (real)q.a);
}
#endif
