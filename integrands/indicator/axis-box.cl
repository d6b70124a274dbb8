// axis-box: 1{x_j <= p_j for all j}, p_j = level - gap / (j + 2), cut to [0, 1]: a box with one corner at
// the origin. gap = 0 gives the same p in every dimension, and at d = 1 a step.
#ifdef KOKSMA_EXACT
static double edge(params q, uint j) { return fmin(fmax(q.level - q.gap / (j + 3.0), 0.0), 1.0); }

static void integrand_setup(params q, uint d, uint j, double *c) { c[0] = edge(q, j); }

static double exact_mean(params q, uint d) {
  double volume = 1;
  for (uint j = 0; j < d; ++j) volume *= edge(q, j);
  return volume;
}

// I (1 - I); 1 - I = 1 - prod (1 - miss_j) grows without a subtraction, for boxes that nearly fill the cube.
static double exact_variance(params q, uint d) {
  double outside = 0;
  for (uint j = 0; j < d; ++j) {
    const double miss = fmin(fmax((1 - q.level) + q.gap / (j + 3.0), 0.0), 1.0);
    outside += (1 - outside) * miss;
  }
  return exact_mean(q, d) * outside;
}

// Every factor falls once, from 1 to 0, unless it is constant; p_1 is the smallest edge.
static double exact_variation(params q, uint d) { return edge(q, 0) < 1 ? 1 : 0; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real inside = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j)
    inside = select_real(points_next(p) <= (real)c[j], inside, R(0.0));
  return inside;
}
#endif
