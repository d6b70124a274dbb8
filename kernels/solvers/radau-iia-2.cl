// radau-iia-2: the Radau IIA method of two stages and order 3, c = (1/3, 1), A = (5 -1; 9 3) / 12 (Hairer and Wanner,
// Solving Ordinary Differential Equations II, table IV.5.5). L-stable; the second stage is the result. Newton's
// method runs on both stages at once: z = (Y1 - y, Y2 - y), 2 KOKSMA_ODE_SIZE unknowns.
#define KOKSMA_RADAU_ROWS (2 * KOKSMA_ODE_SIZE)

static inline void radau_correction(const ode *m, real t, real h, const real *y, const real *z, real *correction) {
  const uint n = KOKSMA_ODE_SIZE, rows = KOKSMA_RADAU_ROWS;
  real state[KOKSMA_ODE_SIZE], f[KOKSMA_RADAU_ROWS], j1[KOKSMA_ODE_SIZE * KOKSMA_ODE_SIZE],
      j2[KOKSMA_ODE_SIZE * KOKSMA_ODE_SIZE];
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) state[i] = y[i] + z[i];
  ode_rhs(m, fma(R(0.33333333333333333333), h, t), state, f);
  ode_jacobian(m, fma(R(0.33333333333333333333), h, t), state, j1);
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) state[i] = y[i] + z[n + i];
  ode_rhs(m, t + h, state, f + n);
  ode_jacobian(m, t + h, state, j2);
  const real twelfth = h / R(12.0);
  real a[KOKSMA_RADAU_ROWS * KOKSMA_RADAU_ROWS];
  mask exchanged[KOKSMA_RADAU_ROWS * KOKSMA_RADAU_ROWS];
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    correction[i] = fma(twelfth, R(5.0) * f[i] - f[n + i], -z[i]);
    correction[n + i] = fma(twelfth, R(9.0) * f[i] + R(3.0) * f[n + i], -z[n + i]);
    KOKSMA_UNROLL
    for (uint j = 0; j < n; ++j) {
      a[i * rows + j] = R(-5.0) * twelfth * j1[i * n + j];
      a[i * rows + n + j] = twelfth * j2[i * n + j];
      a[(n + i) * rows + j] = R(-9.0) * twelfth * j1[i * n + j];
      a[(n + i) * rows + n + j] = R(-3.0) * twelfth * j2[i * n + j];
    }
    a[i * rows + i] += R(1.0);
    a[(n + i) * rows + n + i] += R(1.0);
  }
  lu_factor(a, exchanged, rows);
  lu_solve(a, exchanged, rows, correction);
}

static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const uint n = KOKSMA_ODE_SIZE;
  const real h = (t1 - t0) / (real)(scalar)steps;
  for (uint k = 0; k < steps; ++k) {
    real z[KOKSMA_RADAU_ROWS], correction[KOKSMA_RADAU_ROWS];
    KOKSMA_UNROLL
    for (uint i = 0; i < KOKSMA_RADAU_ROWS; ++i) z[i] = R(0.0);
    mask active = h == h;
    for (uint iteration = 0; iteration < KOKSMA_NEWTON_ITERATIONS && any_lane(active); ++iteration) {
      radau_correction(m, fma((real)(scalar)k, h, t0), h, y, z, correction);
      const real largest = fmax(largest_magnitude(y, n), largest_magnitude(z, KOKSMA_RADAU_ROWS));
      active = newton_update(active, correction, y, largest, z, KOKSMA_RADAU_ROWS);
    }
    KOKSMA_UNROLL
    for (uint i = 0; i < n; ++i) y[i] = select_real(active, KOKSMA_NAN, y[i] + z[n + i]);
  }
}
