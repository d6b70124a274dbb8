// reference-solution: the exact side of nonlinear problems y' = f(y), whose means have no formula: collocation at the
// eight Radau points (the method Radau IIA of order 15: Hairer and Wanner, Solving Ordinary Differential Equations II,
// section IV.5), in double, far more accurate than any solver of the device. The steps double from first to last, so
// that transients on every scale are resolved. The integrand defines the problem:
#ifdef KOKSMA_EXACT
static void reference_rhs(const double *problem, const double *y, double *f);
static void reference_jacobian(const double *problem, const double *y, double *j);
static void legendre_16(uint k, double length, double *y, double *weight);  // exact.cl

#define KOKSMA_STAGES 8
#define KOKSMA_MOST_EQUATIONS 3
#define KOKSMA_UNKNOWNS (KOKSMA_STAGES * KOKSMA_MOST_EQUATIONS)

// Right Radau points on (0, 1]: zeros of P_7 - P_8.
__constant double koksma_radau_points[KOKSMA_STAGES] = {
    0.0224793864387124981088, 0.11467905316090423191,  0.265789822784589468477, 0.452846373669444616999,
    0.647375282886830362626,  0.819759308263107635012, 0.943737439463077853534, 1.0};

// a[i * 8 + j]: the integral over (0, c_i) of the Lagrange polynomial that is 1 at c_j.
static void radau_matrix(double *a) {
  for (uint i = 0; i < KOKSMA_STAGES; ++i)
    for (uint j = 0; j < KOKSMA_STAGES; ++j) {
      double sum = 0;
      for (uint k = 0; k < 16; ++k) {
        double x, product;
        legendre_16(k, koksma_radau_points[i], &x, &product);
        for (uint l = 0; l < KOKSMA_STAGES; ++l)
          if (l != j) product *= (x - koksma_radau_points[l]) / (koksma_radau_points[j] - koksma_radau_points[l]);
        sum += product;
      }
      a[i * KOKSMA_STAGES + j] = sum;
    }
}

// Gauss elimination with partial pivoting; b becomes the solution.
static void solve_linear(double *a, uint n, double *b) {
  for (uint k = 0; k < n; ++k) {
    uint pivot = k;
    for (uint i = k + 1; i < n; ++i)
      if (fabs(a[i * n + k]) > fabs(a[pivot * n + k])) pivot = i;
    for (uint j = k; j < n; ++j) {
      const double old = a[k * n + j];
      a[k * n + j] = a[pivot * n + j];
      a[pivot * n + j] = old;
    }
    const double old = b[k];
    b[k] = b[pivot];
    b[pivot] = old;
    for (uint i = k + 1; i < n; ++i) {
      const double factor = a[i * n + k] / a[k * n + k];
      if (factor == 0) continue;
      for (uint j = k + 1; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
      b[i] -= factor * b[k];
    }
  }
  for (uint k = n; k-- > 0;) {
    for (uint j = k + 1; j < n; ++j) b[k] -= a[k * n + j] * b[j];
    b[k] /= a[k * n + k];
  }
}

// One Newton correction of the stages' increments z (stage by stage) of a step h from y; its size is returned.
static double correct_stages(const double *problem, const double *a, uint n, double h, const double *y, double *z) {
  double matrix[KOKSMA_UNKNOWNS * KOKSMA_UNKNOWNS], right[KOKSMA_UNKNOWNS], f[KOKSMA_UNKNOWNS];
  const uint rows = KOKSMA_STAGES * n;
  for (uint j = 0; j < KOKSMA_STAGES; ++j) {
    double state[KOKSMA_MOST_EQUATIONS], slope[KOKSMA_MOST_EQUATIONS * KOKSMA_MOST_EQUATIONS];
    for (uint k = 0; k < n; ++k) state[k] = y[k] + z[j * n + k];
    reference_rhs(problem, state, f + j * n);
    reference_jacobian(problem, state, slope);
    for (uint i = 0; i < KOKSMA_STAGES; ++i)
      for (uint k = 0; k < n; ++k)
        for (uint l = 0; l < n; ++l)
          matrix[(i * n + k) * rows + j * n + l] =
              (i == j && k == l ? 1 : 0) - h * a[i * KOKSMA_STAGES + j] * slope[k * n + l];
  }
  for (uint i = 0; i < KOKSMA_STAGES; ++i)
    for (uint k = 0; k < n; ++k) {
      double sum = 0;
      for (uint j = 0; j < KOKSMA_STAGES; ++j) sum += a[i * KOKSMA_STAGES + j] * f[j * n + k];
      right[i * n + k] = h * sum - z[i * n + k];
    }
  solve_linear(matrix, rows, right);
  double size = 0;
  for (uint i = 0; i < rows; ++i) {
    z[i] += right[i];
    size = fmax(size, fabs(right[i]));
  }
  return size;
}

// y: the state of n equations at t = 0, then at t = time; steps of time 2^-doublings, the same, twice that, ..., each
// cut in `parts`. a: radau_matrix.
static void reference_solution(const double *problem, const double *a, uint n, double time, uint doublings, uint parts,
                               double *y) {
  for (uint step = 0; step <= doublings * parts; ++step) {
    const uint doubling = step == 0 ? 0 : (step - 1) / parts;
    const double scale = time / exp2((double)(doublings - doubling)), h = step == 0 ? scale : scale / parts;
    double z[KOKSMA_UNKNOWNS] = {0};
    // Newton's method until the corrections are rounding: small ones that no longer shrink.
    double last = INFINITY;
    for (uint iteration = 0; iteration < 20; ++iteration) {
      const double size = correct_stages(problem, a, n, h, y, z);
      if (size < 1e-9 && size >= last / 4) break;
      last = size;
    }
    for (uint k = 0; k < n; ++k) y[k] += z[(KOKSMA_STAGES - 1) * n + k];
  }
}
#endif
