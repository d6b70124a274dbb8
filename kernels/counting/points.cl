// counting/points.cl: around the points' slots that integrands pull on, so that what they cost is the points'.
static inline real counted_next(points *p) {
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_POINTS);
  const real x = points_next(p);
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_INTEGRAND);
  return x;
}
static inline real counted_next_centred(points *p) {
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_POINTS);
  const real x = points_next_centred(p);
  KOKSMA_COUNT_AS(KOKSMA_COUNTED_INTEGRAND);
  return x;
}
#define points_next counted_next
#define points_next_centred counted_next_centred
