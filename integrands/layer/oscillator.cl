// oscillator: cos((w + 1/3) x): flat until N > w / pi, and a test of the argument: the product rounded in fp32 is off by
// up to w 2^-25.
#ifdef KOKSMA_EXACT
#pragma OPENCL FP_CONTRACT OFF
static double frequency(params q) { return q.w + 1.0 / 3; }

// Turns per unit of x, (w + 1/3) / (2 pi), as a number that fp32 holds and the rest. 1 / (2 pi) and 1/3 are pairs of
// doubles.
static void integrand_setup(params q, uint d, uint j, double *c) {
  const double high = 0x1.45f306dc9c883p-3, low = -0x1.6b01ec5417056p-57;
  const double third = 1.0 / 3, third_low = 0x1.5555555555555p-56;
  const double sum = q.w + third, added = sum - q.w;
  const double sum_low = (q.w - (sum - added)) + (third - added) + third_low;
  const double turns = sum * high, turns_low = fma(sum, high, -turns) + (sum * low + sum_low * high);
  c[0] = (float)turns;
  c[1] = (turns - c[0]) + turns_low;
}

// The rounding of w + 1/3 would show in the sine of large ones: sin(w + 1/3) by the sines of both.
static double sine(params q) { return sin(q.w) * cos(1.0 / 3) + cos(q.w) * sin(1.0 / 3); }
static double cosine(params q) { return cos(q.w) * cos(1.0 / 3) - sin(q.w) * sin(1.0 / 3); }

static double exact_mean(params q, uint d) { return sine(q) / frequency(q); }

static double exact_variance(params q, uint d) {
  const double mean = exact_mean(q, d);
  return 0.5 + mean * (cosine(q) / 2 - mean);
}

// int_0^w |cos| = 2n + (-1)^n sin w, n = round(w / pi)
static double exact_mean_abs(params q, uint d) {
  const double n = floor(frequency(q) / M_PI + 0.5);
  return (2 * n + (fmod(n, 2.0) == 0 ? 1 : -1) * sine(q)) / frequency(q);
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  const real x = points_next(p);
#if KOKSMA_FORM_NAIVE
  return cos(((real)q.w + R(0.33333333333333333)) * x);
#else
  // x c[0] and its rounding error; whole turns go before the rest is added.
  const real whole = c[0] * x, rest = fma((real)c[0], x, -whole);
  const real turns = (whole - rint(whole)) + fma((real)c[1], x, rest);
  return cospi(R(2.0) * turns);
#endif
}
#endif
