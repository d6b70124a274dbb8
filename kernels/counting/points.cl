// counting/points.cl: around the points' slot that integrands pull on, so that what it costs is the points'.
static inline real counted_next(points *p) {
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_POINTS);
  const real x = points_next(p);
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_INTEGRAND);
  return x;
}
#define points_next counted_next
