// The solution of -eps u'' + u' = 1, u(0) = u(1) = 0, and its moments over x, uniform on (0,1):
// u = x - (exp((x - 1) / eps) - s) / (1 - s), s = exp(-1 / eps); a layer of width eps at x = 1.
#ifdef KOKSMA_EXACT
static double bvp_mean(double eps) { return 0.5 - eps + 1 / expm1(1 / eps); }

// u = x - v: Var x - 2 Cov(x, v) + Var v with E v = eps - s / (1 - s).
static double bvp_variance(double eps) {
  const double s = exp(-1 / eps), r = 1 - s, mean = eps - s / r;
  const double product = (eps - eps * eps * r - s / 2) / r;
  const double square = (eps / 2 * r * (1 + s) - 2 * s * eps * r + s * s) / (r * r);
  return 1.0 / 12 - 2 * (product - mean / 2) + (square - mean * mean);
}
#else
// inverse = 1 / eps; s = exp(-inverse), which only the stable form uses. The naive form is infinity / infinity where
// exp(x / eps) overflows: at eps = 1e-3 from x = 0.7098 on in fp64, from 0.0887 on in fp32.
static inline real bvp_solution(real x, real inverse, real s) {
#if KOKSMA_FORM_NAIVE
  return x - (exp(x * inverse) - R(1.0)) / (exp(inverse) - R(1.0));
#else
  return x - (exp((x - R(1.0)) * inverse) - s) / (R(1.0) - s);
#endif
}
#endif
