// exponential-integral: E1(x) = integral of exp(-t) / t over t > x, x > 0, for means over rates that are uniform in
// their logarithm. Series and continued fraction: Abramowitz and Stegun 5.1.11 and 5.1.22 (Lentz' evaluation); to
// 4e-15.
#ifdef KOKSMA_EXACT
static double exponential_integral(double x) {
  if (x <= 1) {
    double sum = -0.57721566490153286061 - log(x), term = -1;
    for (uint k = 1; k <= 20; ++k) {
      term *= -x / k;
      sum += term / k;
    }
    return sum;
  }
  double b = x + 1, d = 1 / b, c = 1e300, product = d;
  for (uint k = 1; k <= 150; ++k) {
    const double a = -(double)(k * k);
    b += 2;
    d = 1 / (a * d + b);
    c = b + a / c;
    product *= c * d;
  }
  return exp(-x) * product;
}
#endif
