// rodas4: the Rosenbrock method RODAS of Hairer and Wanner (Solving Ordinary Differential Equations II, section
// IV.7), order 4 with an embedded method of order 3, six stages of one matrix I / (h g) - J, g = 1/4; L-stable, no
// Newton iteration. The coefficients are those of the authors' code in its transformed variables u; the order
// conditions hold to 1e-15 with them. Every lane has its own step.
#define KOKSMA_RODAS_ATTEMPTS 20000

// du = f(t, y + sum_j a_j u_j) + sum_j c_j u_j / h + shift f_t, then the linear system: the stage u of the step.
static inline void rodas_stage(const ode *m, const real *a, const mask *exchanged, real t, real inverse_h,
                               const real *state, const real *coupling, real shift, const real *drift, real *u) {
  ode_rhs(m, t, state, u);
  KOKSMA_UNROLL
  for (uint i = 0; i < KOKSMA_ODE_SIZE; ++i) u[i] += fma(coupling[i], inverse_h, shift * drift[i]);
  lu_solve(a, exchanged, KOKSMA_ODE_SIZE, u);
}

// One step of length h: the result, and the estimate of its error (the last stage).
static inline void rodas_step(const ode *m, real t, real h, const real *y, real *next, real *error) {
  const uint n = KOKSMA_ODE_SIZE;
  const real inverse_h = R(1.0) / h;
  real u1[KOKSMA_ODE_SIZE], u2[KOKSMA_ODE_SIZE], u3[KOKSMA_ODE_SIZE], u4[KOKSMA_ODE_SIZE], u5[KOKSMA_ODE_SIZE],
      drift[KOKSMA_ODE_SIZE], coupling[KOKSMA_ODE_SIZE];
  real a[KOKSMA_ODE_SIZE * KOKSMA_ODE_SIZE];
  mask exchanged[KOKSMA_ODE_SIZE * KOKSMA_ODE_SIZE];
  ode_jacobian(m, t, y, a);
  ode_time_derivative(m, t, y, drift);
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    KOKSMA_UNROLL
    for (uint j = 0; j < n; ++j) a[i * n + j] = -a[i * n + j];
    a[i * n + i] += R(4.0) * inverse_h;
    drift[i] *= h;
    coupling[i] = R(0.0);
  }
  lu_factor(a, exchanged, n);
  rodas_stage(m, a, exchanged, t, inverse_h, y, coupling, R(0.25), drift, u1);

  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    next[i] = fma(R(1.544), u1[i], y[i]);
    coupling[i] = R(-5.6688) * u1[i];
  }
  rodas_stage(m, a, exchanged, fma(R(0.386), h, t), inverse_h, next, coupling, R(-0.1043), drift, u2);

  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    next[i] = y[i] + R(0.9466785280815826) * u1[i] + R(0.2557011698983284) * u2[i];
    coupling[i] = R(-2.430093356833875) * u1[i] + R(-0.2063599157091915) * u2[i];
  }
  rodas_stage(m, a, exchanged, fma(R(0.21), h, t), inverse_h, next, coupling, R(0.1035), drift, u3);

  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    next[i] = y[i] + R(3.314825187068521) * u1[i] + R(2.896124015972201) * u2[i] + R(0.9986419139977817) * u3[i];
    coupling[i] = R(-0.1073529058151375) * u1[i] + R(-9.594562251023355) * u2[i] + R(-20.47028614809616) * u3[i];
  }
  rodas_stage(m, a, exchanged, fma(R(0.63), h, t), inverse_h, next, coupling, R(-0.0362), drift, u4);

  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    next[i] = y[i] + R(1.221224509226641) * u1[i] + R(6.019134481288629) * u2[i] + R(12.53708332932087) * u3[i] +
              R(-0.6878860361058950) * u4[i];
    coupling[i] = R(7.496443313967647) * u1[i] + R(-10.24680431464352) * u2[i] + R(-33.99990352819905) * u3[i] +
                  R(11.70890893206160) * u4[i];
  }
  rodas_stage(m, a, exchanged, t + h, inverse_h, next, coupling, R(0.0), drift, u5);

  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    next[i] += u5[i];
    coupling[i] = R(8.083246795921522) * u1[i] + R(-7.981132988064893) * u2[i] + R(-31.52159432874371) * u3[i] +
                  R(16.31930543123136) * u4[i] + R(-6.058818238834054) * u5[i];
  }
  rodas_stage(m, a, exchanged, t + h, inverse_h, next, coupling, R(0.0), drift, error);
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) next[i] += error[i];
}

// The first step is at most 10 tolerance (t1 - t0): of a longer one that a fast transient lies within, the estimate
// may vanish by chance and the result pass (in Robertson's problem 1 sample of 400 ended on a spurious branch). Later
// the step shrinks or grows by 0.9 (1 / error)^(1/4), within 1/5 and 5, so that the estimate meets the tolerance.
static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y) {
  const uint n = KOKSMA_ODE_SIZE;
  // Smaller tolerances would be met by steps of rounding errors only.
  const real least = fmax(tolerance, (real)KOKSMA_LEAST_TOLERANCE);
  real t = t0, h = (t1 - t0) * fmin(R(10.0) * least, R(1.0) / (real)(scalar)steps);
  mask active = t < t1;
  for (uint attempt = 0; attempt < KOKSMA_RODAS_ATTEMPTS && any_lane(active); ++attempt) {
    // Lanes that are done repeat a step that is dropped.
    const mask last = h >= (t1 - t) * R(0.99999);
    const real step = select_real(active, select_real(last, t1 - t, h), t1 - t0);
    real next[KOKSMA_ODE_SIZE], error[KOKSMA_ODE_SIZE], ratio = R(0.0);
    rodas_step(m, t, step, y, next, error);
    KOKSMA_UNROLL
    for (uint i = 0; i < n; ++i)
      ratio = fmax(ratio, fabs(error[i]) / fma(least, fmax(fabs(y[i]), fabs(next[i])), least));
    const mask broken = any_nonfinite(next, n) | any_nonfinite(error, n);
    const mask accepted = active & (ratio <= R(1.0)) & not_lanes(broken);
    KOKSMA_UNROLL
    for (uint i = 0; i < n; ++i) y[i] = select_real(accepted, next[i], y[i]);
    t = select_real(accepted, select_real(last, t1, t + step), t);
    h = step * select_real(broken, R(0.2), fmin(R(5.0), fmax(R(0.2), R(0.9) / sqrt(sqrt(ratio)))));
    active &= (t < t1) & (t + h > t);  // a step that can not move the time has failed
  }
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) y[i] = select_real(t < t1, KOKSMA_NAN, y[i]);
}
