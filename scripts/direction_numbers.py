#!/usr/bin/env python3
"""Sobol' direction numbers to 21201 dimensions as a file for `koksma --directions`.

The numbers are S. Joe and F. Y. Kuo's new-joe-kuo-6 (Constructing Sobol' sequences with better
two-dimensional projections, SIAM J. Sci. Comput. 30 (2008) 2635-2654), as SciPy carries them.

    python3 -m venv build/python && build/python/bin/pip install scipy
    build/python/bin/python scripts/direction_numbers.py --dim 5000 --out directions.txt
    koksma run --directions directions.txt --scene linear-prod:d=5000 --sampler sobol-owen
"""
import argparse
import os

import numpy
import scipy


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dim", type=int, default=21201, help="dimensions, 2 to 21201")
    parser.add_argument("--out", required=True, help="the file to write, in Joe and Kuo's format")
    options = parser.parse_args()
    path = os.path.join(os.path.dirname(scipy.__file__), "stats", "_sobol_direction_numbers.npz")
    with numpy.load(path) as numbers:
        polynomials, initial = numbers["poly"], numbers["vinit"]
    if not 2 <= options.dim <= len(polynomials):
        parser.error(f"--dim {options.dim}: allowed are 2 to {len(polynomials)}")
    with open(options.out, "w", encoding="ascii") as out:
        out.write("d s a m_i\n")
        for d in range(1, options.dim):
            # x^s + a_1 x^(s-1) + ... + 1 as bits: the ends are left out of a.
            polynomial = int(polynomials[d])
            degree = polynomial.bit_length() - 1
            inner = polynomial >> 1 & (1 << (degree - 1)) - 1
            m = " ".join(str(int(v)) for v in initial[d, :degree])
            out.write(f"{d + 1} {degree} {inner} {m}\n")


if __name__ == "__main__":
    main()
