// terms: what summation is tried on, a constant or random terms: offset + slope x (+-) swing, the sign at random.
// The parameters are arguments, so no compiler can fold a sum of constants. No term is rounded where slope is 1 and
// swing 0; where both count, the rounded values are the data.
static inline real integrand(points *p, params q, coefficients c) {
  real y = (real)q.offset;
  if (q.slope != 0) y += q.slope * points_next(p);
  if (q.swing != 0) y += select_real(points_next(p) < R(0.5), (real)-q.swing, (real)q.swing);
  if (q.absolute != 0) y = fabs(y);
  return y;
}
