// dahlquist: y' = -lambda y, y(0) = 1, lambda = rate x; f = y(1). Dahlquist's test equation: n steps of length h = 1/n
// give R(-lambda h)^n, so that the moments of the numerical solution are known too.
#ifdef KOKSMA_EXACT
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

static double exact_mean(params q, uint d) { return -expm1(-q.rate) / q.rate; }

// E f^2 - (E f)^2; rate >= 1 keeps the cancellation below one digit.
static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return -expm1(-2 * q.rate) / (2 * q.rate) - mean * mean;
}

static double exact_stiffness(params q, uint d) { return q.rate / q.steps; }

static double log_distance(double r) { return r < 0.5 ? log1p(-r) : log(fabs(1 - r)); }

// ln |R(-z)|, exact near z = 0 as the power magnifies its error n times, and the z > 0 at which R(-z) changes its sign.
#if defined(KOKSMA_SOLVER_EXPLICIT_EULER)
#define KOKSMA_SIGN_CHANGE 1.0
static double log_amplification(double z) { return log_distance(z); }
#elif defined(KOKSMA_SOLVER_RK4)
#define KOKSMA_SIGN_CHANGE INFINITY
static double log_amplification(double z) { return log1p(-z * (1 - z / 2 * (1 - z / 3 * (1 - z / 4)))); }
#elif defined(KOKSMA_SOLVER_BACKWARD_EULER)
#define KOKSMA_SIGN_CHANGE INFINITY
static double log_amplification(double z) { return -log1p(z); }
#elif defined(KOKSMA_SOLVER_TRAPEZOID)
#define KOKSMA_SIGN_CHANGE 2.0
static double log_amplification(double z) { return log_distance(z / 2) - log1p(z / 2); }
#elif defined(KOKSMA_SOLVER_SDIRK2)
#define KOKSMA_SIGN_CHANGE 2.41421356237309504880
static double log_amplification(double z) {
  return log_distance(z / KOKSMA_SIGN_CHANGE) - 2 * log1p(0.29289321881345247560 * z);
}
#elif defined(KOKSMA_SOLVER_RADAU_IIA_2)
#define KOKSMA_SIGN_CHANGE 3.0
static double log_amplification(double z) { return log_distance(z / 3) - log1p(z * (2.0 / 3 + z / 6)); }
#endif

#ifdef KOKSMA_SIGN_CHANGE
// The integral of |R(-z)|^power over from < z < to: panels that halve towards `from`, in 64 parts of 16 points. Where
// the result is a double, log |R|^power changes by less than 1500 over the cube, so by little within a part.
static double integrate_power(double power, double from, double to) {
  double sum = 0, length = (to - from) / 2;
  for (uint panel = 0; panel < 60; ++panel, length /= 2) {
    double of_panel = 0;
    for (uint k = 0; k < 64; ++k) {
      double of_part = 0;
      for (uint i = 0; i < 16; ++i) {
        double y, weight;
        legendre_16(i, length / 64, &y, &weight);
        of_part += weight * exp(power * log_amplification(from + length + k * (length / 64) + y));
      }
      of_panel += of_part;
    }
    sum += of_panel;
  }
  return sum;
}

static void discrete_moments(params q, uint d, double *mean, double *variance, double *mean_abs) {
  const double n = q.steps, z = q.rate / n, change = z < KOKSMA_SIGN_CHANGE ? z : KOKSMA_SIGN_CHANGE;
  const double below = integrate_power(n, 0, change) / z, above = change < z ? integrate_power(n, change, z) / z : 0;
  const double squares = (integrate_power(2 * n, 0, change) + (change < z ? integrate_power(2 * n, change, z) : 0)) / z;
  *mean = fmod(n, 2) == 0 ? below + above : below - above;
  *mean_abs = below + above;
  *variance = squares == INFINITY ? INFINITY : squares - *mean * *mean;
}
#else
static void discrete_moments(params q, uint d, double *mean, double *variance, double *mean_abs) {
  *mean = *variance = *mean_abs = NAN;  // steps chosen by the solver
}
#endif
#else
struct ode {
  real rate;
};

static inline void ode_rhs(const ode *m, real t, const real *y, real *f) { f[0] = -m->rate * y[0]; }
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j) { j[0] = -m->rate; }
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g) { g[0] = R(0.0); }

static inline real integrand(points *p, params q, coefficients c) {
  const ode m = {(real)q.rate * points_next(p)};
  real y[KOKSMA_ODE_SIZE] = {R(1.0)};
  ode_solve(&m, R(0.0), R(1.0), (uint)q.steps, (real)q.tolerance, y);
  return y[0];
}
#endif
