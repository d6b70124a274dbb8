// variance-cancel: c + x: the variance 1/12 is lost in E f^2 - (E f)^2 once 12 c^2 u nears 1, and x itself beside a c of
// 1 / u.
#ifdef KOKSMA_EXACT
static double exact_mean(params q, uint d) { return q.c + 0.5; }

static double exact_mean_abs(params q, uint d) {
  if (q.c >= 0) return q.c + 0.5;
  if (q.c <= -1) return -(q.c + 0.5);
  return (q.c * q.c + (1 + q.c) * (1 + q.c)) / 2;
}
#else
static inline real integrand(points *p, params q, coefficients c) { return (real)q.c + points_next(p); }
#endif
