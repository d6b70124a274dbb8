// robertson: Robertson's reaction of three species, y1' = -k1 y1 + k2 y2 y3, y2' = k1 y1 - k2 y2 y3 - k3 y2^2, y3' =
// k3 y2^2, from (1, 0, 0), with k1 = 0.04, k2 = 1e4, k3 = 3e7, of which the first d are random within 10 %; f is the
// concentration of one species at `time`. Rates of 0.04 to 1e4 per unit of time from the start.
#ifdef KOKSMA_EXACT
static void radau_matrix(double *a);
static void reference_solution(const double *problem, const double *a, uint n, double time, uint doublings, uint parts,
                               double *y);

static void reference_rhs(const double *k, const double *y, double *f) {
  f[0] = -k[0] * y[0] + k[1] * y[1] * y[2];
  f[2] = k[2] * y[1] * y[1];
  f[1] = -f[0] - f[2];
}

static void reference_jacobian(const double *k, const double *y, double *j) {
  j[0] = -k[0];
  j[1] = k[1] * y[2];
  j[2] = k[1] * y[1];
  j[6] = j[8] = 0;
  j[7] = 2 * k[2] * y[1];
  for (uint i = 0; i < 3; ++i) j[3 + i] = -j[i] - j[6 + i];
}

// Gauss-Legendre points and weights of 6 points on (0, 1): Abramowitz and Stegun, table 25.4. The solution is singular
// where a rate is 0, at x = -4.5, so that 6 points leave 1e-15.
__constant double rate_points[6] = {0.033765242898423986094, 0.16939530676686774317, 0.38069040695840154568,
                                    0.61930959304159845432, 0.83060469323313225683, 0.96623475710157601391};
__constant double rate_weights[6] = {0.08566224618958517252, 0.18038078652406930378, 0.23395696728634552369,
                                     0.23395696728634552369, 0.18038078652406930378, 0.08566224618958517252};

// The first step is 1e-4 at most: y2 reaches its balance within 1e-3.
static uint doublings_of(params q) { return (uint)fmax(1, ceil(log2(q.time / 1e-4))); }

// The mean of f and its mean square about that, over the product rule in d dimensions.
static void moments(params q, uint d, double *mean, double *variance) {
  double a[64], value[216], weight[216];
  uint points = 1;
  for (uint j = 0; j < d; ++j) points *= 6;
  radau_matrix(a);
  *mean = *variance = 0;
  for (uint i = 0; i < points; ++i) {
    double rates[3] = {0.04, 1e4, 3e7}, y[3] = {1, 0, 0};
    weight[i] = 1;
    for (uint j = 0, rest = i; j < d; ++j, rest /= 6) {
      rates[j] *= 0.9 + 0.2 * rate_points[rest % 6];
      weight[i] *= rate_weights[rest % 6];
    }
    reference_solution(rates, a, 3, q.time, doublings_of(q), 2, y);
    value[i] = y[(uint)q.species - 1];
    *mean += weight[i] * value[i];
  }
  for (uint i = 0; i < points; ++i) *variance += weight[i] * (value[i] - *mean) * (value[i] - *mean);
}

static double exact_mean(params q, uint d) {
  double mean, variance;
  moments(q, d, &mean, &variance);
  return mean;
}

static double exact_variance(params q, uint d) {
  double mean, variance;
  moments(q, d, &mean, &variance);
  return variance;
}

static double exact_bound(params q, uint d) {
  return q.species == 2.0 ? sqrt(1.1 * 0.04 / (0.9 * 3e7)) : 1.0;
}

// The fast eigenvalue is the trace but for O(1): k1 + k2 y3 + 2 k3 y2, largest at the largest rates, either at the end
// or where y2 first balances its loss, 2 sqrt(k1 k3).
static double exact_stiffness(params q, uint d) {
  double a[64], k[3] = {0.04, 1e4, 3e7}, y[3] = {1, 0, 0};
  for (uint j = 0; j < d; ++j) k[j] *= 1.1;
  radau_matrix(a);
  reference_solution(k, a, 3, q.time, doublings_of(q), 2, y);
  const double early = 2 * sqrt(k[0] * k[2]), late = k[0] + k[1] * y[2] + 2 * k[2] * y[1];
  return fmax(early, late) * q.time / q.steps;
}
#else
struct ode {
  real rates[3];
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  const real back = m->rates[1] * y[1] * y[2];
  f[0] = fma(-m->rates[0], y[0], back);
  f[2] = m->rates[2] * y[1] * y[1];
  f[1] = -f[0] - f[2];
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  j[0] = -m->rates[0];
  j[1] = m->rates[1] * y[2];
  j[2] = m->rates[1] * y[1];
  j[6] = j[8] = R(0.0);
  j[7] = R(2.0) * m->rates[2] * y[1];
  KOKSMA_UNROLL
  for (uint i = 0; i < 3; ++i) j[3 + i] = -j[i] - j[6 + i];
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) {
  g[0] = g[1] = g[2] = R(0.0);
}

static inline real integrand(points *p, params q, coefficients c) {
  ode m = {{R(0.04), R(1e4), R(3e7)}};
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) m.rates[j] *= fma(R(0.2), points_next(p), R(0.9));
  real y[KOKSMA_ODE_SIZE] = {R(1.0), R(0.0), R(0.0)};
  ode_solve(&m, R(0.0), (real)q.time, (uint)q.steps, (real)q.tolerance, y);
  const uint species = (uint)q.species;
  if (species == 1) return y[0];
  if (species == 2) return y[1];
  return y[2];
}
#endif
