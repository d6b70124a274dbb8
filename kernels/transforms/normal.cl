// normal.cl: the standard normal quantile, M. J. Wichura, Algorithm AS 241, Appl. Statist. 37 (1988)
// 477-484: PPND16 in fp64, PPND7 in fp32. x in (0,1); x = 0 gives -infinity. On the grids (k + 1/2) 2^-m
// and k 2^-m both x - 1/2 and 1 - x are exact, so the upper tail mirrors the lower one bit for bit.
// Largest error on these grids: 3.6 ulp in fp64 (sampled), 4.9 ulp in fp32 (every point; PPND7 is good to
// 1e-7). Every lane's value depends on that lane alone: any_lane only skips work whose result no lane
// takes.
#define KOKSMA_NORMAL_STEP(r, c) sum = fma(sum, r, R(c));

#if KOKSMA_FP64
// |x - 1/2| <= 0.425, r = 0.425^2 - (x - 1/2)^2: the quantile over x - 1/2.
static inline real normal_centre(real r) {
  real sum = R(2509.0809287301226727);
  KOKSMA_NORMAL_STEP(r, 33430.575583588128105)
  KOKSMA_NORMAL_STEP(r, 67265.770927008700853)
  KOKSMA_NORMAL_STEP(r, 45921.953931549871457)
  KOKSMA_NORMAL_STEP(r, 13731.693765509461125)
  KOKSMA_NORMAL_STEP(r, 1971.5909503065514427)
  KOKSMA_NORMAL_STEP(r, 133.14166789178437745)
  KOKSMA_NORMAL_STEP(r, 3.3871328727963666080)
  const real numerator = sum;
  sum = R(5226.4952788528545610);
  KOKSMA_NORMAL_STEP(r, 28729.085735721942674)
  KOKSMA_NORMAL_STEP(r, 39307.895800092710610)
  KOKSMA_NORMAL_STEP(r, 21213.794301586595867)
  KOKSMA_NORMAL_STEP(r, 5394.1960214247511077)
  KOKSMA_NORMAL_STEP(r, 687.18700749205790830)
  KOKSMA_NORMAL_STEP(r, 42.313330701600911252)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}

// r = sqrt(-log(tail)) - 1.6, tail >= exp(-25)
static inline real normal_tail(real r) {
  real sum = R(7.74545014278341407640e-4);
  KOKSMA_NORMAL_STEP(r, 0.0227238449892691845833)
  KOKSMA_NORMAL_STEP(r, 0.241780725177450611770)
  KOKSMA_NORMAL_STEP(r, 1.27045825245236838258)
  KOKSMA_NORMAL_STEP(r, 3.64784832476320460504)
  KOKSMA_NORMAL_STEP(r, 5.76949722146069140550)
  KOKSMA_NORMAL_STEP(r, 4.63033784615654529590)
  KOKSMA_NORMAL_STEP(r, 1.42343711074968357734)
  const real numerator = sum;
  sum = R(1.05075007164441684324e-9);
  KOKSMA_NORMAL_STEP(r, 5.47593808499534494600e-4)
  KOKSMA_NORMAL_STEP(r, 0.0151986665636164571966)
  KOKSMA_NORMAL_STEP(r, 0.148103976427480074590)
  KOKSMA_NORMAL_STEP(r, 0.689767334985100004550)
  KOKSMA_NORMAL_STEP(r, 1.67638483018380384940)
  KOKSMA_NORMAL_STEP(r, 2.05319162663775882187)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}

// r = sqrt(-log(tail)) - 5, tail < exp(-25): 1 coordinate in 4e10
static inline real normal_far_tail(real r) {
  real sum = R(2.01033439929228813265e-7);
  KOKSMA_NORMAL_STEP(r, 2.71155556874348757815e-5)
  KOKSMA_NORMAL_STEP(r, 0.00124266094738807843860)
  KOKSMA_NORMAL_STEP(r, 0.0265321895265761230930)
  KOKSMA_NORMAL_STEP(r, 0.296560571828504891230)
  KOKSMA_NORMAL_STEP(r, 1.78482653991729133580)
  KOKSMA_NORMAL_STEP(r, 5.46378491116411436990)
  KOKSMA_NORMAL_STEP(r, 6.65790464350110377720)
  const real numerator = sum;
  sum = R(2.04426310338993978564e-15);
  KOKSMA_NORMAL_STEP(r, 1.42151175831644588870e-7)
  KOKSMA_NORMAL_STEP(r, 1.84631831751005468180e-5)
  KOKSMA_NORMAL_STEP(r, 7.86869131145613259100e-4)
  KOKSMA_NORMAL_STEP(r, 0.0148753612908506148525)
  KOKSMA_NORMAL_STEP(r, 0.136929880922735805310)
  KOKSMA_NORMAL_STEP(r, 0.599832206555887937690)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}
#else
// |x - 1/2| <= 0.425, r = 0.425^2 - (x - 1/2)^2: the quantile over x - 1/2.
static inline real normal_centre(real r) {
  real sum = R(59.109374720);
  KOKSMA_NORMAL_STEP(r, 159.29113202)
  KOKSMA_NORMAL_STEP(r, 50.434271938)
  KOKSMA_NORMAL_STEP(r, 3.3871327179)
  const real numerator = sum;
  sum = R(67.187563600);
  KOKSMA_NORMAL_STEP(r, 78.757757664)
  KOKSMA_NORMAL_STEP(r, 17.895169469)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}

// r = sqrt(-log(tail)) - 1.6, tail >= exp(-25): the whole grid, whose last point is 2^-24
static inline real normal_tail(real r) {
  real sum = R(0.17023821103);
  KOKSMA_NORMAL_STEP(r, 1.3067284816)
  KOKSMA_NORMAL_STEP(r, 2.7568153900)
  KOKSMA_NORMAL_STEP(r, 1.4234372777)
  const real numerator = sum;
  sum = R(0.12021132975);
  KOKSMA_NORMAL_STEP(r, 0.73700164250)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}
#endif

static inline real normal_quantile(real x) {
  const real q = x - R(0.5);
  real value = q * normal_centre(fma(-q, q, R(0.180625)));
  const mask in_tail = fabs(q) > R(0.425);
  if (any_lane(in_tail)) {
    const real tail = select_real(q < R(0.0), x, R(1.0) - x);
    const real r = sqrt(-log(tail));
    real size = normal_tail(r - R(1.6));
#if KOKSMA_FP64
    const mask far = r > R(5.0);
    if (any_lane(far)) size = select_real(far, normal_far_tail(r - R(5.0)), size);
#endif
    size = select_real(tail > R(0.0), size, r);  // log(0): infinity
    value = select_real(in_tail, copysign(size, q), value);
  }
  return value;
}
