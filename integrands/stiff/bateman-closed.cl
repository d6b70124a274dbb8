// bateman-closed: the chain A -> B -> C of bateman-chain by its formula. The quotient (exp(-k1) - exp(-k2)) / (k2 -
// k1) is 0/0 where the rates cross: form=stable writes it as exp(-k1) times (1 - exp(-g)) / g with expm1 and g = k2 -
// k1, form=naive as it stands. Exact values: parts/bateman-chain.cl.
#ifndef KOKSMA_EXACT
static inline real integrand(points *p, params q, coefficients c) {
  const real k1 = R(0.5) + points_next(p), k2 = exp10(fma(R(7.0), points_next(p), R(-1.0))), gap = k2 - k1;
#ifdef KOKSMA_FORM_NAIVE
  return R(1.0) - exp(-k1) - k1 * (exp(-k1) - exp(-k2)) / gap;
#else
  const real quotient = select_real(gap == R(0.0), R(1.0), -expm1(-gap) / gap);
  return -expm1(-k1) - k1 * exp(-k1) * quotient;
#endif
}
#endif
