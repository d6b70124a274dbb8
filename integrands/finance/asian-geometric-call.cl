// asian-geometric-call: e^(-rt) max(G - k, 0), G the geometric mean of d prices of a lognormal asset at times i t / d
// (Kemna & Vorst 1990); the path is built from its increments. ln G is linear in the normals: weights alone stream.
#ifdef KOKSMA_EXACT
// The increment j (from 0) enters the log prices j + 1, ..., d.
static double weight_of(params q, uint d, uint j) { return q.sigma * sqrt(q.t / d) * (d - j) / d; }
#endif
