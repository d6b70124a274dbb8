// centred.cl: the slot of centred coordinates, x - 1/2 in units of KOKSMA_CENTRED_UNIT, for families that have none
// of their own. Comes behind the family (and what wraps it): every integrand may draw from either slot.
// Exact: x is a multiple of 2^-m in [0,1) of at most m bits, and so is x - 1/2, of at most as many.
#ifndef KOKSMA_CENTRED_UNIT
#define KOKSMA_CENTRED_UNIT R(1.0)
static inline real points_next_centred(points *p) { return points_next(p) - R(0.5); }
#endif
