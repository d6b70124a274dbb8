// index-points: the sample index itself in place of a coordinate: its bits, plus 1, as a double.
typedef struct {
  ulong first;  // index of the first lane of this item
  uint drawn;
} points;

static inline void points_seek(points *p, __global const word *table, ulong first, ulong n, ulong seed, uint replicate,
                               uint lane) {
  p->first = first + lane;
  p->drawn = 0;
}
static inline real points_next(points *p) {
  ++p->drawn;
  return KOKSMA_AS_REAL((bits)(p->first + 1) + KOKSMA_TO_BITS(lane_numbers()));
}
static inline void points_step(points *p) {
  p->first += KOKSMA_LANES;
  p->drawn = 0;
}
static inline uint points_drawn(const points *p) { return p->drawn; }
