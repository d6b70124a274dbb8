// annuity-ar1: sum over d payments of exp(-dt (r_1 + ... + r_k)), short rates r_k = theta + (r_(k-1) - theta)
// e^(-kappa dt) + vol sqrt(dt) z_k: the discounting of mortgage-backed securities (Caflisch, Morokoff & Owen 1997)
// without their prepayments, which leave no exact value. High nominal, low effective dimension.
#ifdef KOKSMA_EXACT
#define MOST_PAYMENTS 480

// 1 + a + ... + a^(n-1), a = e^(-kappa dt)
static double geometric_sum(params q, uint n) {
  return q.kappa == 0 ? n : expm1(-q.kappa * q.dt * n) / expm1(-q.kappa * q.dt);
}

// -E of the exponent of payment k: dt sum_(j <= k) (theta + (r0 - theta) a^j)
static double mean_exponent(params q, uint k) {
  return q.dt * (q.theta * k + (q.r0 - q.theta) * exp(-q.kappa * q.dt) * geometric_sum(q, k));
}

static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = exp(-mean_exponent(q, j + 1));
  c[1] = exp(-q.kappa * q.dt);
  c[2] = q.vol * sqrt(q.dt) * q.dt;
}

// The exponents of payments k and l have the covariance vol^2 dt^3 sum_(n <= min) B_n B_(n + |k - l|), B_n the
// geometric sum: the random part of the k-th is sum_i B_(k-i+1) z_i.
static double exact_mean(params q, uint d) {
  double mean = 0, variance = 0;
  for (uint k = 1; k <= d; ++k) {
    const double b = geometric_sum(q, k);
    variance += q.vol * q.vol * (q.dt * q.dt * q.dt) * b * b;
    mean += exp(variance / 2 - mean_exponent(q, k));
  }
  return mean;
}

// sum_(k, l) E_k E_l (e^cov(k, l) - 1) with E_k the mean of payment k, by the lags |k - l|.
static double exact_variance(params q, uint d) {
  double b[MOST_PAYMENTS + 1], payment[MOST_PAYMENTS + 1];
  const double unit = q.vol * q.vol * (q.dt * q.dt * q.dt);
  double square = 0, total = 0;
  for (uint k = 1; k <= d; ++k) {
    b[k] = geometric_sum(q, k);
    square += unit * b[k] * b[k];
    payment[k] = exp(square / 2 - mean_exponent(q, k));
  }
  for (uint lag = 0; lag < d; ++lag) {
    double covariance = 0, sum = 0;
    for (uint k = 1; k + lag <= d; ++k) {
      covariance += unit * b[k] * b[k + lag];
      sum += payment[k] * payment[k + lag] * expm1(covariance);
    }
    total += lag == 0 ? sum : 2 * sum;
  }
  return total;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real rate = R(0.0), exponent = R(0.0), sum = R(0.0);  // the random parts, in units of dt
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    rate = fma((real)c[2], normal_quantile(points_next(p)), c[1] * rate);
    exponent += rate;
    sum = fma((real)c[3 * j], exp(-exponent), sum);
  }
  return sum;
}
#endif
