// singular-perturbed-bvp: the solution of -eps u'' + u' = 1, u(0) = u(1) = 0, at a uniform x: x but for a boundary
// layer of width eps at x = 1.
#ifdef KOKSMA_EXACT
static void integrand_setup(params q, uint d, uint j, double *c) {
  c[0] = 1 / q.eps;
  c[1] = exp(-1 / q.eps);
}

static double exact_mean(params q, uint d) { return bvp_mean(q.eps); }
static double exact_variance(params q, uint d) { return bvp_variance(q.eps); }
#else
static inline real integrand(points *p, params q, coefficients c) {
  return bvp_solution(points_next(p), (real)c[0], (real)c[1]);
}
#endif
