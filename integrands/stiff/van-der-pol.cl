// van-der-pol: y1' = y2, y2' = ((1 - y1^2) y2 - y1) / eps, eps = 10^(-2 - decades x1), y1(0) = 1.8 + 0.4 x2, y2(0) =
// -2/3; f = y1(0.4). The scaled oscillator of Hairer and Wanner, Solving Ordinary Differential Equations II, section
// IV.10, on its slow branch y2 = y1 / (1 - y1^2), which the state reaches within eps, well before the first jump (t =
// 0.53 from 1.8).
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl
static void radau_matrix(double *a);
static void reference_solution(const double *problem, const double *a, uint n, double time, uint doublings, uint parts,
                               double *y);

static void reference_rhs(const double *rate, const double *y, double *f) {
  f[0] = y[1];
  f[1] = *rate * ((1 - y[0] * y[0]) * y[1] - y[0]);
}

static void reference_jacobian(const double *rate, const double *y, double *j) {
  j[0] = 0;
  j[1] = 1;
  j[2] = -*rate * (2 * y[0] * y[1] + 1);
  j[3] = *rate * (1 - y[0] * y[0]);
}

// The mean of f, and its mean square about that. f is a power series in eps, so 16 points reach over all decades.
static void moments(params q, double *mean, double *variance) {
  double a[64], value[256], weight[256];
  radau_matrix(a);
  *mean = *variance = 0;
  for (uint i = 0; i < 256; ++i) {
    double x1, x2, other;
    legendre_16(i % 16, 1, &x1, &weight[i]);
    legendre_16(i / 16, 1, &x2, &other);
    weight[i] *= other;
    double rate = pow(10.0, 2 + q.decades * x1), y[2] = {1.8 + 0.4 * x2, -2.0 / 3};
    reference_solution(&rate, a, 2, 0.4, (uint)(2 + log2(rate)), 4, y);
    value[i] = y[0];
    *mean += weight[i] * value[i];
  }
  for (uint i = 0; i < 256; ++i) *variance += weight[i] * (value[i] - *mean) * (value[i] - *mean);
}

static double exact_mean(params q, uint d) {
  double mean, variance;
  moments(q, &mean, &variance);
  return mean;
}

static double exact_variance(params q, uint d) {
  double mean, variance;
  moments(q, &mean, &variance);
  return variance;
}

// The fast eigenvalue is (1 - y1^2) / eps, up to O(1).
static double exact_stiffness(params q, uint d) { return (2.2 * 2.2 - 1) * pow(10.0, 2 + q.decades) * 0.4 / q.steps; }
#else
struct ode {
  real rate;  // 1 / eps
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) {
  f[0] = y[1];
  f[1] = m->rate * fma(fma(-y[0], y[0], R(1.0)), y[1], -y[0]);
}
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  j[0] = R(0.0);
  j[1] = R(1.0);
  j[2] = -m->rate * fma(R(2.0) * y[0], y[1], R(1.0));
  j[3] = m->rate * fma(-y[0], y[0], R(1.0));
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = g[1] = R(0.0); }

static inline real integrand(points *p, params q, coefficients c) {
  const ode m = {exp10(fma((real)q.decades, points_next(p), R(2.0)))};
  real y[KOKSMA_ODE_SIZE] = {fma(R(0.4), points_next(p), R(1.8)), R(-0.66666666666666666667)};
  ode_solve(&m, R(0.0), R(0.4), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
