#!/usr/bin/env python3
"""Fits the coefficients of kernels/transforms/normal.cl and writes tests/normal_reference.json.

    python3 -m venv build/venv && build/venv/bin/pip install mpmath
    build/venv/bin/python scripts/normal_quantile.py           # prints coefficients and errors, writes the file
    build/venv/bin/python scripts/normal_quantile.py --check   # verifies the committed kernel and file instead

It takes about ten seconds. Form, z the standard normal quantile:
    centre, q = x - 1/2, r = SPLIT - q^2 >= 0:   z / q = 3 + N(r) / D(r);
    tail, t = min(x, 1 - x), w = sqrt(-log t):   |z| = 181/128 w - N(w - 2) / D(w - 2), down to t = 2^-32 or 2^-64.
r and w are Wichura's variables (Algorithm AS 241, Appl. Statist. 37, 1988, 477-484). SPLIT, 3 and 181/128 are exact in
both precisions, so that no fit is spoilt by rounding them, and they carry the larger part of the value: rounding
errors of N / D count for less. Every D has positive coefficients only and loses nothing to cancellation.

Method: the exchange algorithm of Remez for the relative error of z. On a reference of n + m + 2 points the levelled
error E is an eigenvalue: divided differences of order n + 1 annihilate N, which leaves A d = E B d for the
coefficients d of D; of the real eigenvalues only that whose D has one sign on the reference is of use. Degrees are
raised one at a time, each from the extrema of the last, because the points crowd where the quantile is nearly singular.
"""
import argparse
import json
import pathlib
import re
import statistics
import sys

from mpmath import acos, cos, eig, erfc, exp, im, inverse, log, lu_solve, matrix, mp, mpf, nstr, pi, sqrt
from mpmath import re as real_part

mp.dps = 90
ROOT = pathlib.Path(__file__).resolve().parent.parent
KERNEL = ROOT / "kernels" / "transforms" / "normal.cl"
REFERENCE = ROOT / "tests" / "normal_reference.json"

OFFSET = mpf(3)  # of the centre
SLOPE = mpf(181) / 128  # of the tail, near sqrt 2
START = mpf(2)  # where the tail's variable begins


class Fit:
    """What one precision needs: degrees are those of N and D."""

    def __init__(self, name, mantissa, split, centre, tail, smallest, digits):
        self.name, self.mantissa, self.split, self.digits = name, mantissa, mpf(split), digits
        self.centre, self.tail, self.smallest = centre, tail, mpf(smallest)
        self.seam = mpf(1) / 2 - sqrt(self.split)


FITS = [
    Fit("fp64", 52, "0.24755859375", (14, 14), (8, 8), mpf(2) ** -64, 19),
    Fit("fp32", 23, "0.2490234375", (8, 8), (2, 3), mpf(2) ** -32, 10),
]


def upper_quantile(t):
    """z > 0 with tail probability t < 1/2: Halley's iteration from a double."""
    z = mpf(-statistics.NormalDist().inv_cdf(float(t)))
    for _ in range(8):
        u = (erfc(z / sqrt(2)) / 2 - t) * sqrt(2 * pi) * exp(z * z / 2)
        step = u / (1 - z * u / 2)
        z += step
        if abs(step) < mpf(10) ** (12 - mp.dps) * abs(z):
            break
    return z


def polynomial(coefficients, x):
    value = mpf(0)
    for c in reversed(coefficients):
        value = value * x + c
    return value


def levelled(x, f, weight, n, m):
    """N, D and E with weight (f - N / D) = +-E on the reference x, or None where no D keeps its sign."""
    differences = matrix(m + 1, n + m + 2)
    for row in range(m + 1):
        window = range(row, row + n + 2)
        for i in window:
            product = mpf(1)
            for j in window:
                product *= x[i] - x[j] if i != j else 1
            differences[row, i] = 1 / product
        scale = max(abs(differences[row, i]) for i in window)
        for i in window:
            differences[row, i] /= scale
    points = range(n + m + 2)
    values = differences * matrix([[f[i] * x[i] ** j for j in range(m + 1)] for i in points])
    signs = differences * matrix([[(-1) ** i / weight[i] * x[i] ** j for j in range(m + 1)] for i in points])
    eigenvalues, vectors = eig(inverse(signs) * values)
    best = None
    for e, value in enumerate(eigenvalues):
        if abs(im(value)) > abs(value) * mpf(10) ** -15:
            continue
        largest = max((vectors[j, e] for j in range(m + 1)), key=abs)
        d = [real_part(vectors[j, e] / largest) for j in range(m + 1)]
        if len({polynomial(d, p) > 0 for p in x}) == 1 and (best is None or abs(value) < abs(best[0])):
            best = real_part(value), d
    if best is None:
        return None
    error, d = best
    d = [c / d[0] for c in d]
    right = [(f[i] - (-1) ** i * error / weight[i]) * polynomial(d, x[i]) for i in range(n + 1)]
    solved = lu_solve(matrix([[x[i] ** j for j in range(n + 1)] for i in range(n + 1)]), matrix(right))
    return list(solved), d, error


def alternating_extrema(error, count):
    """Indices of the largest error of each sign change, the smaller end dropped until `count` are left."""
    extrema = []
    for i, e in enumerate(error):
        if extrema and (error[extrema[-1]] > 0) == (e > 0):
            if abs(e) > abs(error[extrema[-1]]):
                extrema[-1] = i
        else:
            extrema.append(i)
    while len(extrema) > count:
        extrema.pop(0 if abs(error[extrema[0]]) < abs(error[extrema[-1]]) else -1)
    return extrema


def remez(function, weight, place, n, m, reference):
    """Best N, D, largest weighted error and extrema; place maps [-1, 1] to the variable, reference lies in [-1, 1]."""
    count = n + m + 2
    v = [-cos(pi * i / (40 * count)) for i in range(40 * count + 1)]
    x = [place(p) for p in v]
    f = [function(p) for p in x]
    scale = [weight(p) for p in x]
    chosen = [min(range(len(v)), key=lambda i: abs(v[i] - p)) for p in reference]
    best = None
    for _ in range(12):
        solution = levelled([x[i] for i in chosen], [f[i] for i in chosen], [scale[i] for i in chosen], n, m)
        if solution is None:
            break
        numerator, denominator, level = solution
        error = [s * (y - polynomial(numerator, p) / polynomial(denominator, p)) for s, y, p in zip(scale, f, x)]
        largest = max(abs(e) for e in error)
        extrema = alternating_extrema(error, count)
        if len(extrema) < count:
            break
        if best is None or largest < best[2]:
            best = numerator, denominator, largest, [v[i] for i in extrema]
        if largest < abs(level) * mpf("1.01"):
            break
        chosen = extrema
    if best is None:
        sys.exit(f"no fit of degrees {n}, {m}")
    return best


def stretched(extrema, count):
    """The extrema as angles, their distance from even spacing interpolated to `count` of them."""
    last = len(extrema) - 1
    distance = [acos(-p) - pi * i / last for i, p in enumerate(extrema)]
    result = []
    for i in range(count):
        place = mpf(i) * last / (count - 1)
        j = min(int(place), last - 1)
        part = place - j
        result.append(-cos(pi * i / (count - 1) + distance[j] * (1 - part) + distance[j + 1] * part))
    return result


def raise_degrees(function, weight, place, degrees):
    n, m = degrees
    extrema = [-cos(pi * i / (m - n + 3)) for i in range(m - n + 4)]
    for k in range(1, n + 1):
        best = remez(function, weight, place, k, k + m - n, stretched(extrema, 2 * k + m - n + 2))
        extrema = best[3]
    return best[:3]


def remembered(function):
    known = {}

    def lookup(x):
        if x not in known:
            known[x] = function(x)
        return known[x]

    return lookup


def fit_centre(fit):
    gap = mpf(1) / 4 - fit.split  # the quantile is singular at r = -gap

    def ratio(r):
        square = fit.split - r
        return sqrt(2 * pi) if square < mpf(10) ** -40 else upper_quantile(mpf(1) / 2 - sqrt(square)) / sqrt(square)

    ratio = remembered(ratio)
    low, high = log(gap), log(mpf(1) / 4)

    def place(v):
        return min(max(exp((low + high) / 2 + (high - low) / 2 * v) - gap, mpf(0)), fit.split)

    numerator, denominator, error = raise_degrees(ratio, lambda r: 1 / ratio(r), place, fit.centre)
    return [a - OFFSET * b for a, b in zip(numerator, denominator)], denominator, error


def fit_tail(fit):
    low, high = (sqrt(-log(t)) - START for t in (fit.seam, fit.smallest))
    size = remembered(lambda s: upper_quantile(exp(-((s + START) ** 2))))
    return raise_degrees(lambda s: SLOPE * (s + START) - size(s), lambda s: 1 / size(s),
                         lambda v: low + (high - low) / 2 * (1 + v), fit.tail)


def literal(value, digits):
    return nstr(value, digits, min_fixed=-4, max_fixed=8, strip_zeros=False) if value != 1 else "1.0"


def report_coefficients(fit):
    """Prints the two fits, highest coefficient first, and returns the literals."""
    literals = []
    for part, (numerator, denominator, error) in (("centre", fit_centre(fit)), ("tail", fit_tail(fit))):
        print(f"{fit.name} {part}: largest relative error of the quantile {nstr(error, 2)}")
        if min(denominator) <= 0:
            sys.exit("a coefficient of D is not positive")
        for label, coefficients in (("N", numerator), ("D", denominator)):
            written = [literal(c, fit.digits) for c in reversed(coefficients)]
            print(f"  {label}:", *written, sep="\n    ")
            literals += written
    print(f"{fit.name} seam: t = {nstr(fit.seam, 8)}", flush=True)
    return literals


# Of 1.6e7 points in fp64, some with the largest errors (PoCL 3.1, x86-64), as fractions of 2^53.
WORST = [
    204930105018345, 206400893088133, 208004751797945, 209334788747969, 210051021198525, 210457175450549,
    211339922020753, 213320989532305, 213859555400561, 218387527551209, 219574947629729, 220392543046057,
]


def reference_points():
    """Grid points of fp64 as fractions of 2^53: ends, seam, every binade, near 1/2, where errors are largest."""
    one, fit = 1 << 53, FITS[0]
    seam = int(fit.seam * one)
    points = [1, 3, 5, 7, 9, one // 2 - 1, one // 2 - 3, one // 2 - 5, one // 4 + 1, 1 << 23, 1 << 33]
    points += [(seam | 1) + 2 * i for i in range(-8, 9)]
    points += [int(seam * f / 64) | 1 for f in range(32, 128)]
    points += [(int(f * (1 << e)) | 1) for e in range(2, 52) for f in (1.0, 1.17, 1.39, 1.61, 1.83)]
    points += [one // 2 - (int(f * (1 << e)) | 1) for e in range(3, 52) for f in (1.1, 1.7)]
    points += [i * one // 1024 | 1 for i in range(2, 512, 3)]
    points += WORST
    return sorted(set(points))


def references():
    rows = []
    for k in reference_points():
        z = -upper_quantile(mpf(k) / (1 << 53))
        rows.append([(k / (1 << 53)).hex(), nstr(z, 30, min_fixed=-3)])
    return {"command": "scripts/normal_quantile.py", "quantiles": rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="verify the committed kernel and references")
    check = parser.parse_args().check
    literals = sum((report_coefficients(fit) for fit in FITS), [])
    text = json.dumps(references(), indent=1) + "\n"
    text = re.sub(r'\[\s+("[^"]*"),\s+("[^"]*")\s+\]', r"[\1, \2]", text)
    if not check:
        REFERENCE.write_text(text)
        return 0
    kernel = re.findall(r"(?:sum = R\(|STEP\(r, )([^)]+)\)", KERNEL.read_text())[1:]  # the first is the macro's own
    if kernel != literals or REFERENCE.read_text() != text:
        sys.exit("the committed kernel or reference file differs from the fit")
    print("the committed kernel and reference file are those of the fit")
    return 0


if __name__ == "__main__":
    sys.exit(main())
