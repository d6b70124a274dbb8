// flame: y' = y^2 - y^3, y(0) = delta = 10^(2x - 4); f = y(700). The radius of a flame that smoulders, ignites about
// t = 1/delta and is stiff from then on (C. B. Moler, Numerical Computing with MATLAB, SIAM 2004, section 7.9). y(t)
// = 1 / (w + 1) with w exp(w) = a exp(a - t), a = 1/delta - 1 (Lambert's W). As a function of x it is a front at
// delta = 1/700.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

// a exp(a - t) overflows: u = ln w solves exp(u) + u = ln a + a - t, which is convex, so that Newton's method
// converges.
static double radius(double a) {
  const double right = log(a) + a - 700;
  double u = right > 1 ? log(right) : right;
  for (uint k = 0; k < 60; ++k) u -= (exp(u) + u - right) / (exp(u) + 1);
  return 1 / (exp(u) + 1);
}

// E (f - centre)^power over a, where dx = da / (2 ln 10 (1 + a)): on both sides panels that halve towards the front at
// a = 700, where f changes over a length of 1; its nearest poles are pi away.
static double moment(double centre, int power) {
  double sum = 0;
  for (uint side = 0; side < 2; ++side) {
    double outer = side == 0 ? 99 - 700.0 : 9999 - 700.0;
    for (uint panel = 0; panel < 13; ++panel, outer /= 2) {
      const double inner = panel < 12 ? outer / 2 : 0, length = (outer - inner) / 2;
      for (uint k = 0; k < 32; ++k) {
        double y, weight;
        legendre_16(k % 16, length, &y, &weight);
        const double a = 700 + inner + (k < 16 ? 0 : length) + y;
        sum += fabs(weight) * pown(radius(a) - centre, power) / (2 * log(10.0) * (1 + a));
      }
    }
  }
  return sum;
}

static double exact_mean(params q, uint d) { return moment(0, 1); }
static double exact_variance(params q, uint d) { return moment(moment(0, 1), 2); }
// The burning state y = 1 has f'(y) = -1, the steepest there is.
static double exact_stiffness(params q, uint d) { return 700 / q.steps; }
#else
struct ode {
  uint unused;
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) { f[0] = y[0] * y[0] * (R(1.0) - y[0]); }
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) {
  j[0] = y[0] * fma(R(-3.0), y[0], R(2.0));
}
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = R(0.0); }

static inline real integrand(points *p, params q, coefficients c) {
  ode m;
  m.unused = 0;
  real y[KOKSMA_ODE_SIZE] = {exp10(fma(R(2.0), points_next(p), R(-4.0)))};
  ode_solve(&m, R(0.0), R(700.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
