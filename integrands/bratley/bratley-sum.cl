// bratley-sum: sum_{i=1}^d (-1)^i prod_{j<=i} x_j, f_4 of Bratley, Fox & Niederreiter (1992): "type A", the first
// few coordinates carry nearly everything. Always negative: f_d(x_1, ...) = -x_1 (1 + f_{d-1}(x_2, ...)).
#ifdef KOKSMA_EXACT
// Two coordinates more multiply what they change by 1/4 (mean) and 1/9 (variance): done long before d = 65536.
static double exact_mean(params q, uint d) {
  double mean = 0;
  for (uint j = 0; j < d; ++j) mean = -(1 + mean) / 2;
  return mean;
}

// f_d = -x Y, Y = 1 + f_{d-1}: Var f_d = E x^2 Var Y + Var x (E Y)^2, without a subtraction.
static double exact_variance(params q, uint d) {
  double mean = 0, variance = 0;
  for (uint j = 0; j < d; ++j) {
    variance = variance / 3 + (1 + mean) * (1 + mean) / 12;
    mean = -(1 + mean) / 2;
  }
  return variance;
}

static double exact_mean_abs(params q, uint d) { return -exact_mean(q, d); }

// At the anchor 1 the mixed derivative of a set with largest index k is sum_{i>=k} (-1)^i: +-1 for the 2^(k-1) sets
// with d - k even, 0 for the others.
static double exact_variation(params q, uint d) {
  double variation = 0;
  for (uint k = d % 2 == 1 ? 1 : 2; k <= d; k += 2) variation += ldexp(0.5, (int)k);
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0), sum = R(0.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    product *= -points_next(p);
    sum += product;
  }
  return sum;
}
#endif
