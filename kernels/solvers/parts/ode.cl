// ode.cl: what a solver of initial value problems y' = f(t, y) and the integrand whose samples are such problems
// agree on, and the linear algebra of implicit methods. Every lane of `real` is its own problem: lanes pivot, converge
// and step by themselves, so the value of a sample does not depend on its neighbours. The integrand defines
// KOKSMA_ODE_SIZE (before), struct ode and the three functions of it; a solver defines ode_solve.
typedef struct ode ode;
static inline void ode_rhs(const ode *m, real t, const real *y, real *f);
static inline void ode_jacobian(const ode *m, real t, const real *y, real *j);  // j[row * KOKSMA_ODE_SIZE + column]
static inline void ode_time_derivative(const ode *m, real t, const real *y, real *g);  // of f at fixed y

// y: the state at t0, then at t1. Fixed-step solvers take `steps` equal steps. Adaptive ones begin with a step of at
// most that length and keep the estimated error of every step and component below tolerance (1 + |y|). A lane that
// fails (Newton's iteration or the step size) ends as NaN, never as a number that looks like a solution.
static inline void ode_solve(const ode *m, real t0, real t1, uint steps, real tolerance, real *y);

// Exponent and first mantissa bit set: a quiet NaN, also where the compiler assumes that there are none.
#define KOKSMA_NAN KOKSMA_AS_REAL((bits)((word)KOKSMA_ONE_PATTERN * 2 + ((word)3 << (KOKSMA_MANTISSA_BITS - 1))))

// Newton's iteration ends where the last correction of every component is below this share of it, about eps^(2/3), or
// 16 eps of the largest number of the equation: it converges quadratically, so what is left is below rounding, and
// rounding of the residual can not keep it from ending. Nor can denormal numbers, which have no relative accuracy.
#if KOKSMA_FP64
#define KOKSMA_NEWTON_SHARE R(4e-11)
#define KOKSMA_NEWTON_FLOOR R(3.6e-15)
#define KOKSMA_NEWTON_LEAST R(2.2250738585072014e-308)
#else
#define KOKSMA_NEWTON_SHARE R(3e-5)
#define KOKSMA_NEWTON_FLOOR R(1.9e-6)
#define KOKSMA_NEWTON_LEAST R(1.17549435e-38)
#endif
#define KOKSMA_NEWTON_ITERATIONS 25

static inline void exchange_lanes(mask m, real *a, real *b) {
  const real old = *a;
  *a = select_real(m, *b, old);
  *b = select_real(m, old, *b);
}

// LU factors of the n by n matrix a, by rows, with partial pivoting: rows are compared one by one with the pivot's
// and exchanged where they are larger, in each lane by itself; exchanged[i * n + k], i > k, says in which. The
// diagonal of U is kept inverted.
static inline void lu_factor(real *a, mask *exchanged, uint n) {
  KOKSMA_UNROLL
  for (uint k = 0; k < n; ++k) {
    KOKSMA_UNROLL
    for (uint i = k + 1; i < n; ++i) {
      const mask larger = fabs(a[i * n + k]) > fabs(a[k * n + k]);
      exchanged[i * n + k] = larger;
      KOKSMA_UNROLL
      for (uint j = k; j < n; ++j) exchange_lanes(larger, &a[k * n + j], &a[i * n + j]);
    }
    const real inverse = R(1.0) / a[k * n + k];
    a[k * n + k] = inverse;
    KOKSMA_UNROLL
    for (uint i = k + 1; i < n; ++i) {
      const real factor = a[i * n + k] * inverse;
      a[i * n + k] = factor;
      KOKSMA_UNROLL
      for (uint j = k + 1; j < n; ++j) a[i * n + j] = fma(-factor, a[k * n + j], a[i * n + j]);
    }
  }
}

// b becomes the solution. Exchanges are replayed with the elimination: a factor stays in its row as
// later columns exchange only what is right of it.
static inline void lu_solve(const real *a, const mask *exchanged, uint n, real *b) {
  KOKSMA_UNROLL
  for (uint k = 0; k < n; ++k) {
    KOKSMA_UNROLL
    for (uint i = k + 1; i < n; ++i) exchange_lanes(exchanged[i * n + k], &b[k], &b[i]);
    KOKSMA_UNROLL
    for (uint i = k + 1; i < n; ++i) b[i] = fma(-a[i * n + k], b[k], b[i]);
  }
  KOKSMA_UNROLL
  for (uint back = 0; back < n; ++back) {
    const uint k = n - 1 - back;
    KOKSMA_UNROLL
    for (uint j = k + 1; j < n; ++j) b[k] = fma(-a[k * n + j], b[j], b[k]);
    b[k] *= a[k * n + k];
  }
}

static inline real largest_magnitude(const real *v, uint n) {
  real largest = R(0.0);
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) largest = fmax(largest, fabs(v[i]));
  return largest;
}

static inline mask any_nonfinite(const real *v, uint n) {
  mask found = nonfinite_lanes(v[0]);
  KOKSMA_UNROLL
  for (uint i = 1; i < n; ++i) found |= nonfinite_lanes(v[i]);
  return found;
}

// One correction of Newton's iteration, in the lanes that are active: z += correction; returned are the lanes that go
// on. y + z[0 ... size - 1], y + z[size ... 2 size - 1], ... are the states, `largest` bounds the terms of the
// equations. A lane that left the range of numbers stops: its NaN or infinity is what the sample becomes.
static inline mask newton_update(mask active, const real *correction, const real *y, real largest, real *z, uint n) {
  const real least = fma(KOKSMA_NEWTON_FLOOR, largest, KOKSMA_NEWTON_LEAST);
  mask large = active & not_lanes(active);
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) {
    z[i] = select_real(active, z[i] + correction[i], z[i]);
    large |= fabs(correction[i]) > fmax(KOKSMA_NEWTON_SHARE * fabs(y[i % KOKSMA_ODE_SIZE] + z[i]), least);
  }
  return active & large & not_lanes(any_nonfinite(z, n));
}

// The stage y = base + c f(t, y) of a diagonally implicit method; y comes as the first guess. Lanes that have not
// converged at the bound of the iteration become NaN.
static inline void implicit_stage(const ode *m, real t, real c, const real *base, real *y) {
  const uint n = KOKSMA_ODE_SIZE;
  real origin[KOKSMA_ODE_SIZE];
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) origin[i] = R(0.0);
  mask active = c == c;
  for (uint iteration = 0; iteration < KOKSMA_NEWTON_ITERATIONS && any_lane(active); ++iteration) {
    real correction[KOKSMA_ODE_SIZE], a[KOKSMA_ODE_SIZE * KOKSMA_ODE_SIZE];
    mask exchanged[KOKSMA_ODE_SIZE * KOKSMA_ODE_SIZE];
    ode_rhs(m, t, y, correction);
    ode_jacobian(m, t, y, a);
    KOKSMA_UNROLL
    for (uint i = 0; i < n; ++i) {
      correction[i] = fma(c, correction[i], base[i] - y[i]);
      KOKSMA_UNROLL
      for (uint j = 0; j < n; ++j) a[i * n + j] *= -c;
      a[i * n + i] += R(1.0);
    }
    lu_factor(a, exchanged, n);
    lu_solve(a, exchanged, n, correction);
    // The terms are y, base and, as their difference, c f.
    const real largest = fmax(largest_magnitude(base, n), largest_magnitude(y, n));
    active = newton_update(active, correction, origin, largest, y, n);
  }
  KOKSMA_UNROLL
  for (uint i = 0; i < n; ++i) y[i] = select_real(active, KOKSMA_NAN, y[i]);
}
