// asian-geometric-call-pca: asian-geometric-call with the path built from the principal components of its covariance,
// the largest first (Acworth, Broadie & Glasserman 1998). Same law, same exact values.
#ifdef KOKSMA_EXACT
// Eigenpairs of min(i, l) t / d (Glasserman 2003, section 3.1): sqrt(t / d) / (2 sin u), 2 sin(2 i u) / sqrt(2 d + 1)
// with u = (2 j + 1) pi / (2 (2 d + 1)), j from 0. The sines add up to cos u / (2 sin u) over i = 1, ..., d.
static double weight_of(params q, uint d, uint j) {
  const double whole = 2.0 * d + 1, sine = sinpi((2 * j + 1) / (2 * whole)), cosine = sinpi((d - j) / whole);
  return q.sigma * sqrt(q.t / d / whole) * cosine / (2 * d * sine * sine);
}
#endif
