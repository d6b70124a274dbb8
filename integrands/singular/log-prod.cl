// log-prod: prod_j (-ln x_j), -ln x being exponentially distributed. Singular on the faces x_j = 0,
// where x = 0 gives infinity.
#ifdef KOKSMA_EXACT
// E (ln x)^2 = 2
static double exact_variance(params q, uint d) { return ldexp(1.0, (int)d) - 1; }
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) product *= -log(points_next(p));
  return product;
}
#endif
