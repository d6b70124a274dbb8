// normal.cl: the standard normal quantile. x in (0,1); x = 0 gives -infinity. Rational functions of the variables of
// M. J. Wichura, Algorithm AS 241, Appl. Statist. 37 (1988) 477-484; the coefficients are the project's own minimax
// fits: scripts/normal_quantile.py states the form and the method, prints every constant and checks this file.
// On the grids (k + 1/2) 2^-m and k 2^-m both x - 1/2 and 1 - x are exact, so the upper tail mirrors the lower one bit
// for bit. Largest error on these grids, PoCL 3.1: 2.4 ulp in fp32 (every point; none falls below its predecessor),
// 2.7 ulp in fp64 (1.6e7 points). Every lane's value depends on that lane alone: any_lane only skips work whose
// result no lane takes. The centre reaches far out because the tail's logarithm costs more than the rest and a single
// lane asks for it: 1 vector of 16 in 32 does so in fp32, 1 in 13 in fp64.
#define KOKSMA_NORMAL_STEP(r, c) sum = fma(sum, r, R(c));

#if KOKSMA_FP64
#define KOKSMA_NORMAL_SPLIT R(0.24755859375)

// q = x - 1/2, r = KOKSMA_NORMAL_SPLIT - q^2 >= 0: the quantile over q, less 3. Relative error of the quantile
// by the fit: 2.9e-17.
static inline real normal_centre(real r) {
  real sum = R(-7.219179412369229481e+19);
  KOKSMA_NORMAL_STEP(r, -3.428259535762414498e+20)
  KOKSMA_NORMAL_STEP(r, -3.608698557206783180e+20)
  KOKSMA_NORMAL_STEP(r, -1.239012188575234892e+20)
  KOKSMA_NORMAL_STEP(r, -1.278379119044844810e+19)
  KOKSMA_NORMAL_STEP(r, 6.963866080077469507e+17)
  KOKSMA_NORMAL_STEP(r, 2.110616356496454502e+17)
  KOKSMA_NORMAL_STEP(r, 1.485154772857486870e+16)
  KOKSMA_NORMAL_STEP(r, 4.981974503790951214e+14)
  KOKSMA_NORMAL_STEP(r, 9.107696067803512294e+12)
  KOKSMA_NORMAL_STEP(r, 9.541513685460017022e+10)
  KOKSMA_NORMAL_STEP(r, 5.805784044540914937e+8)
  KOKSMA_NORMAL_STEP(r, 2007455.669395252255)
  KOKSMA_NORMAL_STEP(r, 3631.751270542721564)
  KOKSMA_NORMAL_STEP(r, 2.655436623403423190)
  const real numerator = sum;
  sum = R(2.821692442423599141e+19);
  KOKSMA_NORMAL_STEP(r, 1.811733170573855086e+20)
  KOKSMA_NORMAL_STEP(r, 2.747396776351826192e+20)
  KOKSMA_NORMAL_STEP(r, 1.566380640120650151e+20)
  KOKSMA_NORMAL_STEP(r, 4.090345086926309639e+19)
  KOKSMA_NORMAL_STEP(r, 5.449372091433958418e+18)
  KOKSMA_NORMAL_STEP(r, 3.960421281604631689e+17)
  KOKSMA_NORMAL_STEP(r, 1.642339797022430147e+16)
  KOKSMA_NORMAL_STEP(r, 4.009233490473983440e+14)
  KOKSMA_NORMAL_STEP(r, 5.881154485632605184e+12)
  KOKSMA_NORMAL_STEP(r, 5.232735969918689775e+10)
  KOKSMA_NORMAL_STEP(r, 2.806268481091633993e+8)
  KOKSMA_NORMAL_STEP(r, 877612.1207209050793)
  KOKSMA_NORMAL_STEP(r, 1463.272109595508985)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}

// r = sqrt(-log(tail)) - 2, 0.00245 > tail >= 2^-64: 1.4140625 (r + 2) less the quantile's size. Relative
// error of the quantile by the fit: 4.9e-21.
static inline real normal_tail(real r) {
  real sum = R(-3.211693566362997372e-9);
  KOKSMA_NORMAL_STEP(r, 1.651269228956977795e-7)
  KOKSMA_NORMAL_STEP(r, 6.410279970315605824e-5)
  KOKSMA_NORMAL_STEP(r, 0.002311964291264131424)
  KOKSMA_NORMAL_STEP(r, 0.03097758706335627760)
  KOKSMA_NORMAL_STEP(r, 0.1987961683606862570)
  KOKSMA_NORMAL_STEP(r, 0.6633921386389262691)
  KOKSMA_NORMAL_STEP(r, 1.111986359506274687)
  KOKSMA_NORMAL_STEP(r, 0.7382750170287090605)
  const real numerator = sum;
  sum = R(3.522585053672604841e-8);
  KOKSMA_NORMAL_STEP(r, 1.628730222667587333e-5)
  KOKSMA_NORMAL_STEP(r, 7.604403941566336006e-4)
  KOKSMA_NORMAL_STEP(r, 0.01313458972835707475)
  KOKSMA_NORMAL_STEP(r, 0.1109916258758051221)
  KOKSMA_NORMAL_STEP(r, 0.5125757329973914949)
  KOKSMA_NORMAL_STEP(r, 1.324623788741246896)
  KOKSMA_NORMAL_STEP(r, 1.799544345066777058)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}
#else
#define KOKSMA_NORMAL_SPLIT R(0.2490234375)

// q = x - 1/2, r = KOKSMA_NORMAL_SPLIT - q^2 >= 0: the quantile over q, less 3. Relative error of the quantile
// by the fit: 3.0e-9.
static inline real normal_centre(real r) {
  real sum = R(-2.789415704e+13);
  KOKSMA_NORMAL_STEP(r, -2.430449932e+13)
  KOKSMA_NORMAL_STEP(r, -1.580124493e+12)
  KOKSMA_NORMAL_STEP(r, 3.480434447e+11)
  KOKSMA_NORMAL_STEP(r, 2.452150210e+10)
  KOKSMA_NORMAL_STEP(r, 4.232672683e+8)
  KOKSMA_NORMAL_STEP(r, 2444479.065)
  KOKSMA_NORMAL_STEP(r, 5044.035664)
  KOKSMA_NORMAL_STEP(r, 3.206091463)
  const real numerator = sum;
  sum = R(1.235268180e+13);
  KOKSMA_NORMAL_STEP(r, 2.081639745e+13)
  KOKSMA_NORMAL_STEP(r, 6.590030722e+12)
  KOKSMA_NORMAL_STEP(r, 6.039787835e+11)
  KOKSMA_NORMAL_STEP(r, 1.892973966e+10)
  KOKSMA_NORMAL_STEP(r, 2.206016878e+8)
  KOKSMA_NORMAL_STEP(r, 1000938.774)
  KOKSMA_NORMAL_STEP(r, 1759.296213)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}

// r = sqrt(-log(tail)) - 2, 0.00098 > tail >= 2^-32: 1.4140625 (r + 2) less the quantile's size. Relative
// error of the quantile by the fit: 4.2e-10.
static inline real normal_tail(real r) {
  real sum = R(0.01974334461);
  KOKSMA_NORMAL_STEP(r, 0.2925877667)
  KOKSMA_NORMAL_STEP(r, 0.7382721739)
  const real numerator = sum;
  sum = R(0.005003074406);
  KOKSMA_NORMAL_STEP(r, 0.1272665508)
  KOKSMA_NORMAL_STEP(r, 0.6896385457)
  KOKSMA_NORMAL_STEP(r, 1.0)
  return numerator / sum;
}
#endif

static inline real normal_quantile(real x) {
  const real q = x - R(0.5);
  const real r = fma(-q, q, KOKSMA_NORMAL_SPLIT);
  // 3 q stands apart so that rounding errors of the fraction weigh less: 2.4 ulp instead of 7.3 in fp32.
  real value = fma(q, normal_centre(r), R(3.0) * q);
  const mask in_tail = r < R(0.0);
  if (any_lane(in_tail)) {
    const real tail = select_real(q < R(0.0), x, R(1.0) - x);
    const real w = sqrt(-log(tail));
    real size = fma(R(1.4140625), w, -normal_tail(w - R(2.0)));
    size = select_real(tail > R(0.0), size, w);  // log(0): infinity
    value = select_real(in_tail, copysign(size, q), value);
  }
  return value;
}
