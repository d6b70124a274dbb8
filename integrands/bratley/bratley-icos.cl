// bratley-icos: prod_i i cos(i x_i), f_2 of Bratley, Fox & Niederreiter (1992): oscillation and weight grow with
// the coordinate; sigma grows like d! / 2^(d/2) while the mean falls like 2^-d.
#ifdef KOKSMA_EXACT
// i / pi in two parts: the first has so few bits that the phase keeps what the product with x rounds off.
static void integrand_setup(params q, uint d, uint j, double *c) {
  const double i = j + 1;
  c[0] = (float)(i * M_1_PI);
  c[1] = fma(i, M_1_PI, -c[0]) + i * -1.9678676675182486e-17;
}

static double exact_mean(params q, uint d) {
  double mean = 1;
  for (uint i = 1; i <= d; ++i) mean *= sin((double)i);
  return mean;
}

// E g^2 = i^2 / 2 + i sin(2i) / 4; Var(f g) = Var f E g^2 + (E f)^2 Var g, where only Var g is a difference.
static double exact_variance(params q, uint d) {
  double mean = 1, variance = 0;
  for (uint k = 1; k <= d; ++k) {
    const double i = k, m = sin(i);
    const double square = i * i / 2 + i * sin(2 * i) / 4;
    variance = variance * square + mean * mean * (square - m * m);
    mean *= m;
  }
  return variance;
}

// int_0^i |cos t| dt over k zeros of the cosine
static double exact_mean_abs(params q, uint d) {
  double product = 1;
  for (uint i = 1; i <= d; ++i) {
    const uint k = (uint)(i * M_1_PI + 0.5);
    product *= 2.0 * k + (k % 2 == 0 ? 1 : -1) * sin((double)i);
  }
  return product;
}

static void add_variation_factor(double value_at_one, double total_variation, double *variation,
                                 double *at_one);  // exact.cl

// i int_0^i |sin t| dt over k zeros of the sine inside
static double exact_variation(params q, uint d) {
  double variation = 0, at_one = 1;
  for (uint i = 1; i <= d; ++i) {
    const uint k = (uint)(i * M_1_PI);
    const double rise = 2.0 * k + 1 - (k % 2 == 0 ? 1 : -1) * cos((double)i);
    add_variation_factor(i * cos((double)i), i * rise, &variation, &at_one);
  }
  return variation;
}
#else
static inline real integrand(points *p, params q, coefficients c) {
  real product = R(1.0);
  KOKSMA_UNROLL
  for (uint j = 0; j < KOKSMA_DIM; ++j) {
    const real x = points_next(p);
    const real phase = x * c[2 * j];
    const real rest = fma(x, (real)c[2 * j + 1], fma(x, (real)c[2 * j], -phase));
    const real whole = R(2.0) * rint(R(0.5) * phase);  // full turns, taken off exactly
    product *= (real)(j + 1) * cospi((phase - whole) + rest);
  }
  return product;
}
#endif
